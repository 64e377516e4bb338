#include "app/commands/animate.h"
#include "app/commands/check.h"
#include "app/commands/encode.h"
#include "app/commands/export.h"
#include "app/commands/fetch.h"
#include "app/commands/info.h"
#include "app/commands/nodes.h"
#include "app/commands/open.h"
#include "app/commands/options/command_line.h"
#include "app/commands/options/desktop_files.h"
#include "app/commands/options/options.h"
#include "app/commands/print.h"
#include "app/commands/serve.h"
#include "app/commands/trace.h"

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>

// Table of all commands.
namespace gs::app {
namespace {

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

template <class Options>
Options options_of_run(int (*)(const Options&));

template <auto run, auto check = nullptr>
constexpr CommandCalls calls() {
  using Options = decltype(options_of_run(run));
  CommandCalls calls;
  calls.defaults = []() -> std::unique_ptr<CommandOptions> { return std::make_unique<Options>(); };
  calls.run = [](const CommandOptions& options) { return run(static_cast<const Options&>(options)); };
  calls.check = [](const CommandOptions& options) -> std::optional<std::string> {
    if constexpr (std::is_null_pointer_v<decltype(check)>)
      return std::nullopt;
    else
      return check(static_cast<const Options&>(options));
  };
  return calls;
}

constexpr CommandRow kCommands[] = {
    {"open", "[FILE|URL...]",
     "open files in a window, or draw one with --snapshot; without a file, open the demo world", 0, kAny,
     calls<run_open, check_open>()},
    {"animate", "IN OUT",
     "draw numbered pictures (walk.%04d.png) or a movie (walk.mp4, walk.webm) of a turntable, simulated time, a tour "
     "of Viewpoints or a series of files such as run.%04d.vti",
     2, 2, calls<run_animate, check_animate>(), true},
    {"check", "FILE...", "report problems of files; status 1 if there is an error", 1, kAny, calls<run_check>()},
    {"print", "FILE", "print the scene as VRML97 text, or as classic X3D text", 1, 1, calls<run_print>()},
    {"trace", "FILE", "print the events of simulated time, one per line: TIME NODE.eventOut VALUE", 1, 1,
     calls<run_trace, check_trace>()},
    {"info", "FILE", "list the contents of a file", 1, 1, calls<run_info>()},
    {"encode", "IN... OUT.qnv",
     "convert a world, mesh, volume, splats or points to a QNV stream; --method outlines makes outline groups. Several "
     "volumes, also run.%04d.nrrd, are the steps of a time series",
     2, kAny, calls<run_encode, check_encode>(), true},
    {"export", "IN OUT",
     "convert scenes to X3D and VRML97; meshes, splats and points to STL, OBJ, PLY, glTF, SPZ and SOG", 2, 2,
     calls<run_export, check_export>(), true},
    {"serve", "FOLDER", "serve a folder of worlds and streams, with an index, thumbnails and encoding on demand", 0, 1,
     calls<run_serve, check_serve>()},
    {"fetch", "URL", "read a file and report bytes, vectors, time to the first picture and losses", 1, 1,
     calls<run_fetch, check_fetch>()},
    {"nodes", "", "print the node types", 0, 0, calls<run_nodes>()},
    {"man", "", "print the manual page (roff)", 0, 0, calls<run_man>()},
    {"desktop", "NAME", "print a file for a desktop or shell: entry, mime, thumbnailer, metainfo, bash, zsh or fish", 1,
     1, calls<run_desktop, check_desktop>()},
};

}  // namespace

std::span<const CommandRow> command_rows() { return kCommands; }

}  // namespace gs::app
