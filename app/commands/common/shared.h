#pragma once

#include "app/base/exit_status.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace gs {
class Diagnostics;
}

namespace gs::app {

class Simulation;
class WaveFile;
struct LoadOptions;
struct LoadingOptions;
struct SimulationOptions;

// Functions that several commands use.

/// Writes the sound of a simulation, if requested. Returns kDone, or prints the reason and returns kFailed.
[[nodiscard]] int write_sound(const SimulationOptions& options, const WaveFile& sound);
/// Reads the file of `--input`, if given, and plans its rows in `simulation`. Prints its errors and returns false if it
/// has any.
[[nodiscard]] bool plan_input(const SimulationOptions& options, Simulation& simulation);
/// Sets the time zone to UTC, so that programs of worlds depend only on the simulated clock. Call before everything
/// else.
void use_universal_time();
/// Prints the messages of a simulation of the world `path` after it has run.
void tell_of_simulation(const SimulationOptions& options, const std::string& path, Simulation& simulation);

/// Prints diagnostics to standard error, one per line.
void print_diagnostics(const Diagnostics& diagnostics);
/// Writes the measurements of a run (`--stats`), a JSON object, to a file; "-" means standard output. Prints errors and
/// returns the exit status. Replaces an existing file only if it holds such measurements, so that a mistyped name does
/// not destroy a world.
[[nodiscard]] int write_stats(const std::string& path, const std::string& json);
/// Prints "ghostspace: error: WHAT" to standard error and returns kFailed.
int fail(const std::string& what);
/// Prints "ghostspace: error: WHAT" to standard error and returns kNotWritten.
int fail_to_write(const std::string& what);
/// Returns the reason why `bytes`, made from the file `in`, must not replace `out`: it is another kind of file, or `in`
/// itself. Returns nullopt if they may. Protects worlds from mistyped names.
[[nodiscard]] std::optional<std::string> refuse_to_replace(const std::string& out, const std::string& in,
                                                           std::span<const std::byte> bytes);
/// Returns the list of export formats: ".ply (PLY points), .glb (...), ...".
[[nodiscard]] std::string export_format_list();
/// Returns the options for reading files. Local worlds may also read the files of the command line.
[[nodiscard]] LoadOptions load_options(const LoadingOptions& options);
/// Returns the folder of the HTTP cache: in $XDG_CACHE_HOME, else ~/.cache; empty if there is neither.
[[nodiscard]] std::string http_cache_folder();
/// Returns the peak memory of this process, in bytes.
[[nodiscard]] std::size_t peak_memory();
/// Returns the path of the demo world: beside the installed program, else in the source tree.
[[nodiscard]] std::string demo_world();

}  // namespace gs::app
