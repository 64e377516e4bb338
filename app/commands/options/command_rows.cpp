#include "app/commands/options/commands.h"
#include "app/commands/options/options.h"

#include <cstddef>
#include <limits>

// Table of commands.
namespace gs::app {
namespace {

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
constexpr CommandRow kCommands[] = {
    {"open", "[FILE|URL...]", "show worlds in a window, or draw one with --snapshot; without a file, the demo world", 0,
     kAny, run_open, check_open},
    {"animate", "IN OUT",
     "draw an animation as pictures (OUT: walk.%04d.png) or a movie (walk.mp4, walk.webm): a turntable, the world's "
     "own "
     "time, a tour of its Viewpoints, or a series of files like run.%04d.vti",
     2, 2, run_animate, check_animate},
    {"check", "FILE...", "read files and report what is wrong with them; status 1 if any has an error", 1, kAny,
     run_check},
    {"print", "FILE", "print a file as VRML97 text", 1, 1, run_print},
    {"trace", "FILE", "print the events of simulated time, a line each: TIME NODE.eventOut VALUE", 1, 1, run_trace,
     check_trace},
    {"info", "FILE", "tell what is inside a file", 1, 1, run_info},
    {"encode", "IN OUT.qnv",
     "turn a world, mesh, volume or splats into a QNV stream; with --outlines polygons into a world of outline groups",
     2, 2, run_encode, check_encode},
    {"export", "IN OUT", "write the vectors of a stream, volume, splats or mesh in another program's format", 2, 2,
     run_export, check_export},
    {"serve", "FOLDER", "serve an archive: worlds and streams, with an index, thumbnails and encoding on demand", 1, 1,
     run_serve},
    {"fetch", "URL", "read a world or stream and report: bytes, vectors, time to the first picture, what was lost", 1,
     1, run_fetch, check_fetch},
    {"nodes", "", "print the table of node types", 0, 0, run_nodes},
    {"man", "", "print the manual page (roff)", 0, 0, run_man},
    {"desktop", "NAME",
     "print a file that tells a desktop or a shell of the program: entry, mime, thumbnailer, metainfo, bash, zsh or "
     "fish",
     1, 1, run_desktop, check_desktop},
};

}  // namespace

std::span<const CommandRow> command_rows() { return kCommands; }

}  // namespace gs::app
