#include "app/commands/options/commands.h"
#include "app/commands/options/options.h"

#include <cstddef>
#include <limits>

// Table of commands.
namespace gs::app {
namespace {

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
constexpr CommandRow kCommands[] = {
    {"open", "[FILE|URL...]",
     "open files in a window, or draw one with --snapshot; without a file, open the demo world", 0, kAny, run_open,
     check_open},
    {"animate", "IN OUT",
     "draw numbered pictures (walk.%04d.png) or a movie (walk.mp4, walk.webm) of a turntable, simulated time, a tour "
     "of Viewpoints or a series of files such as run.%04d.vti",
     2, 2, run_animate, check_animate},
    {"check", "FILE...", "report problems of files; status 1 if there is an error", 1, kAny, run_check},
    {"print", "FILE", "print the scene as VRML97 text", 1, 1, run_print},
    {"trace", "FILE", "print the events of simulated time, one per line: TIME NODE.eventOut VALUE", 1, 1, run_trace,
     check_trace},
    {"info", "FILE", "list the contents of a file", 1, 1, run_info},
    {"encode", "IN OUT.qnv",
     "convert a world, mesh, volume, splats or points to a QNV stream, or polygons to outline groups with --outlines",
     2, 2, run_encode, check_encode},
    {"export", "IN OUT", "write meshes and vectors in other formats", 2, 2, run_export, check_export},
    {"serve", "FOLDER", "serve a folder of worlds and streams, with an index, thumbnails and encoding on demand", 1, 1,
     run_serve},
    {"fetch", "URL", "read a file and report bytes, vectors, time to the first picture and losses", 1, 1, run_fetch,
     check_fetch},
    {"nodes", "", "print the node types", 0, 0, run_nodes},
    {"man", "", "print the manual page (roff)", 0, 0, run_man},
    {"desktop", "NAME", "print a file for a desktop or shell: entry, mime, thumbnailer, metainfo, bash, zsh or fish", 1,
     1, run_desktop, check_desktop},
};

}  // namespace

std::span<const CommandRow> command_rows() { return kCommands; }

}  // namespace gs::app
