#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Standard output and standard error. All output of the program passes through these functions. The only exception is
/// the access log of `serve`, which escapes its own text. Text from files, servers and file names is escaped: unescaped
/// text can move the cursor of a terminal, change its title, or type into it. Standard output: one thread at a time.
/// Standard error: any thread.
namespace gs::app {

/// Returns `text` in a form that cannot control a terminal. Control characters (C0, DEL, C1), line ends and
/// bidirectional controls become \n, \t, \x1b or \u202e. Bytes that are not UTF-8 become \xff.
[[nodiscard]] std::string printable(std::string_view text);

/// Prints a line of results on standard output, escaped.
void print_line(const char* format, ...) __attribute__((format(printf, 1, 2)));
/// Prints a formatted result, which may have several lines, on standard output. A file or pipe gets it unchanged. On a
/// terminal, everything except line ends and tabs is escaped.
void print_text(std::string_view text);
/// Returns true if a write to standard output has failed. More output is then useless. finish_output() returns the
/// reason.
[[nodiscard]] bool output_failed();
/// Prints a message on standard error, as one escaped line.
void complain(const char* format, ...) __attribute__((format(printf, 1, 2)));
/// Replaces the progress line of a terminal on standard error. An empty text removes the line. `text` must be trusted.
/// Does nothing if standard error is not a terminal.
void show_progress(std::string_view text);
[[nodiscard]] bool progress_shows();

/// Opens those standard descriptors that the parent process has closed. Otherwise, messages could go into other files.
/// Call first of all.
void prepare_console();
/// Flushes standard output. Returns the first error of the whole program run, or nullopt.
[[nodiscard]] std::optional<std::string> finish_output();

}  // namespace gs::app
