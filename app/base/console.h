#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Standard output and standard error: nothing else in the program writes to them (but the access log of `serve`, which
/// escapes for itself). Texts of files, servers and names never reach a terminal as they are: they could move its
/// cursor, change its title, or type into it. One thread at a time for standard output; any for standard error.
namespace gs::app {

/// Text in which nothing controls a terminal: control characters (C0, DEL, C1), line ends among them, and characters
/// that turn the direction of what follows become \n, \t, \x1b or \u202e; bytes that are no UTF-8 become \xff.
[[nodiscard]] std::string printable(std::string_view text);

/// A result, on a line of standard output. Printable.
void print_line(const char* format, ...) __attribute__((format(printf, 1, 2)));
/// A result in a format of its own, which may be of several lines, on standard output: as it is in files and pipes,
/// printable but for line ends and tabs on a terminal.
void print_text(std::string_view text);
/// Whether writing to standard output failed before: more of it is of no use. finish_output() says why.
[[nodiscard]] bool output_failed();
/// A message, on a line of standard error. Printable.
void complain(const char* format, ...) __attribute__((format(printf, 1, 2)));
/// The last line of a terminal on standard error, in the place of what was shown there before; empty: nothing any more.
/// The text must be ours. Nothing happens where standard error is no terminal.
void show_progress(std::string_view text);
[[nodiscard]] bool progress_shows();

/// To be called before anything else: descriptors that were closed by whoever started the program are taken, so that no
/// file that is opened gets messages into it.
void prepare_console();
/// Brings all of standard output to where it goes. What went wrong with it since the beginning, if anything.
[[nodiscard]] std::optional<std::string> finish_output();

}  // namespace gs::app
