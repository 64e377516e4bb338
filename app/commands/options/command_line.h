#pragma once

#include <string>

namespace gs::app {

struct CommandOptions;

/// Returns the manual page (roff, section 1). The tables of options and commands are its source.
[[nodiscard]] std::string manual_page();
/// Prints the manual page.
int run_man(const CommandOptions&);

/// Reports whether a command line starts a child process of this program, which decodes files or runs Scripts.
[[nodiscard]] bool is_child_call(int count, char** arguments);

/// Parses a command line and runs the command. Prints usage errors. Returns the exit status.
int run_command_line(int count, char** arguments);

}  // namespace gs::app
