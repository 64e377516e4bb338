#pragma once

#include <optional>
#include <string>

namespace gs::app {

struct Options;

// Commands of the table in command_rows.cpp, one file each. They print and return the exit status.
int run_open(const Options& options);
int run_animate(const Options& options);
std::optional<std::string> check_animate(const Options& options);
int run_check(const Options& options);
int run_print(const Options& options);
int run_nodes(const Options& options);
int run_man(const Options& options);
int run_desktop(const Options& options);
std::optional<std::string> check_desktop(const Options& options);
int run_info(const Options& options);
int run_encode(const Options& options);
/// Encodes polygons as outline groups (`encode --outlines`).
int encode_outlines(const Options& options);
int run_export(const Options& options);
int run_serve(const Options& options);
int run_fetch(const Options& options);
int run_trace(const Options& options);
std::optional<std::string> check_encode(const Options& options);
std::optional<std::string> check_export(const Options& options);
std::optional<std::string> check_fetch(const Options& options);
std::optional<std::string> check_open(const Options& options);
std::optional<std::string> check_trace(const Options& options);

/// Draws one world without a window (`--snapshot`).
int run_snapshot(const Options& options, const std::string& file);

}  // namespace gs::app
