#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Standard output and standard error. All output of the program passes through these functions, except the access log
/// of `serve`, which escapes its own text. Texts of files, servers and names are escaped, because raw text can move the
/// cursor of a terminal, change its title, or type into it. Standard output: one thread at a time; standard error: any
/// thread.
namespace gs::app {

/// Returns text that cannot control a terminal. Control characters (C0, DEL, C1), line ends and bidirectional controls
/// become \n, \t, \x1b or \u202e; bytes that are not UTF-8 become \xff.
[[nodiscard]] std::string printable(std::string_view text);

/// Prints a result as one escaped line on standard output.
void print_line(const char* format, ...) __attribute__((format(printf, 1, 2)));
/// Prints a result in an own format, possibly of several lines, on standard output. Files and pipes get the raw text;
/// on a terminal everything but line ends and tabs is escaped.
void print_text(std::string_view text);
/// Returns true if writing to standard output has failed, so that more output is useless. finish_output() returns the
/// reason.
[[nodiscard]] bool output_failed();
/// Prints a message as one escaped line on standard error.
void complain(const char* format, ...) __attribute__((format(printf, 1, 2)));
/// Replaces the last line of a terminal on standard error; an empty text removes it. The text must be trusted.
/// Does nothing if standard error is not a terminal.
void show_progress(std::string_view text);
[[nodiscard]] bool progress_shows();

/// Opens standard descriptors that the parent process has closed, so that messages never go into other files. Call
/// before everything else.
void prepare_console();
/// Flushes standard output. Returns the first error since the start of the program, or nullopt.
[[nodiscard]] std::optional<std::string> finish_output();

}  // namespace gs::app
