#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace gs::vrml {
class Diagnostics;
}
namespace gs::render {
enum class SplatPath : std::uint8_t;
}

namespace gs::app {

class Simulation;
class WaveFile;
struct LoadOptions;
struct Options;

// What several commands do.

/// Writes what was heard in a run of simulated time, where that is wanted: kDone, or kFailed and why is printed.
[[nodiscard]] int write_sound(const Options& options, const WaveFile& sound);
/// Reads the file of `--input`, if there is one, into what `simulation` does; prints what is wrong with it.
[[nodiscard]] bool plan_input(const Options& options, Simulation& simulation);
/// Programs of worlds in simulated time know no other time zone than that of the simulated clock. Call it first of all.
void use_universal_time();
/// Prints what is to be told of it once time has gone by.
void tell_of_simulation(const Options& options, Simulation& simulation);

/// Which path draws vectors, by the value of `--splats`.
[[nodiscard]] render::SplatPath splat_path(const std::string& name);

/// Prints diagnostics to stderr, a line each.
void print_diagnostics(const vrml::Diagnostics& diagnostics);
/// Writes the measurements of a run (`--stats`), a JSON object, complaining on stderr; the exit status of that. To
/// standard output where the path is "-". A file that is there is only written over if it holds such measurements: a
/// mistyped name must not cost a world.
[[nodiscard]] int write_stats(const std::string& path, const std::string& json);
/// "ghostspace: error: WHAT" on stderr; kFailed.
int fail(const std::string& what);
/// The same with kNotWritten.
int fail_to_write(const std::string& what);
/// What to say when `bytes` made from the file `in` must not be written to `out`: there is another kind of file, or
/// `in` itself. Nothing when they may: a mistyped name must not cost a world.
[[nodiscard]] std::optional<std::string> refuse_to_replace(const std::string& out, const std::string& in,
                                                           std::span<const std::byte> bytes);
/// ".ply (PLY points), .glb (...), ...": what export writes.
[[nodiscard]] std::string export_format_list();
/// What the command line says of the reading of files, of which those it names may be read by any world of this
/// machine.
[[nodiscard]] LoadOptions load_options(const Options& options);
/// Where answers of servers are kept between runs: in $XDG_CACHE_HOME, else ~/.cache; empty when there is neither.
[[nodiscard]] std::string http_cache_folder();
/// The largest memory this process has held, in bytes.
[[nodiscard]] std::size_t peak_memory();
/// The demo world: beside the program where it was installed, else in the source tree.
[[nodiscard]] std::string demo_world();

}  // namespace gs::app
