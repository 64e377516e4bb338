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

// Functions for several commands.

/// Writes the sound of a simulation if the options give a file for it. Returns kDone. On failure, prints the reason and
/// returns kFailed.
[[nodiscard]] int write_sound(const SimulationOptions& options, const WaveFile& sound);
/// Reads the file of `--input`, if given, and adds its rows to `simulation`. Prints the errors of the file. Returns
/// false if there are any.
[[nodiscard]] bool plan_input(const SimulationOptions& options, Simulation& simulation);
/// Sets the time zone to UTC, so that programs of worlds depend only on the simulated time. Call first of all.
void use_universal_time();
/// Prints each error and warning of the programs of a simulation at once, as a diagnostic, and adds it to `told`.
/// `told` must outlive the simulation.
void tell_of_programs(Simulation& simulation, Diagnostics& told);
/// Prints the messages of a simulation. Call after the simulation of the world `path` has run.
void tell_of_simulation(const SimulationOptions& options, const std::string& path, Simulation& simulation);

/// Prints diagnostics on standard error, one per line.
void print_diagnostics(const Diagnostics& diagnostics);
/// Writes the measurements of a run (`--stats`) to a file, as a JSON object. "-" means standard output. Replaces an
/// existing file only if it has such measurements, so that a wrong name does not destroy a world. Prints errors.
/// Returns the exit status.
[[nodiscard]] int write_stats(const std::string& path, const std::string& json);
/// Prints "ghostspace: error: WHAT" on standard error. Returns kFailed.
int fail(const std::string& what);
/// Prints "ghostspace: error: WHAT" on standard error. Returns kNotWritten.
int fail_to_write(const std::string& what);
/// Returns an error if the file `out` must not be replaced by `bytes`, which were made from the file `in`. That is so
/// if `out` is `in`, or a file of another kind. Protects worlds from wrong names. Returns nullopt if `out` may be
/// written.
[[nodiscard]] std::optional<std::string> refuse_to_replace(const std::string& out, const std::string& in,
                                                           std::span<const std::byte> bytes);
/// Returns the list of export formats as text: ".ply (PLY points), .glb (...), ...".
[[nodiscard]] std::string export_format_list();
/// Returns the options for loading files. A local world may also read the other files of the command line.
[[nodiscard]] LoadOptions load_options(const LoadingOptions& options);
/// Returns the folder of the HTTP cache, in $XDG_CACHE_HOME or else in ~/.cache. Empty if neither exists.
[[nodiscard]] std::string http_cache_folder();
/// Returns the peak memory of this process in bytes.
[[nodiscard]] std::size_t peak_memory();
/// Returns the path of the demo world: next to the installed program, else in the source tree.
[[nodiscard]] std::string demo_world();

}  // namespace gs::app
