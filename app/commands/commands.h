#pragma once

#include "app/opened_world.h"
#include "app/options.h"

#include <string>

namespace gs::app {

// The commands of the table in options.cpp, a file each. They print and return the exit status.
int run_open(const Options& options);
int run_check(const Options& options);
int run_print(const Options& options);
int run_nodes(const Options& options);
int run_man(const Options& options);

/// Draws one world without a window (`--snapshot`).
int run_snapshot(const Options& options, const std::string& file);

/// Prints diagnostics to stderr, a line each.
void print_diagnostics(const vrml::Diagnostics& diagnostics);
/// Writes the measurements of a run (`--stats`), a JSON object, complaining on stderr; false when that failed. A
/// file that is there is only written over if it holds such measurements: a mistyped name must not cost a world.
bool write_stats(const std::string& path, const std::string& json);
/// The largest memory this process has held, in bytes.
[[nodiscard]] std::size_t peak_memory();
/// The demo world: beside the program where it was installed, else in the source tree.
[[nodiscard]] std::string demo_world();

}  // namespace gs::app
