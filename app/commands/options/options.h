#pragma once

#include "app/commands/common/option_groups.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// Option. Parsing, --help and the manual page are made from these rows.
struct OptionRow {
  std::string_view name;      // "--size"
  std::string_view argument;  // "WxH"; empty for a flag; "[=BITS]" if it is optional
  std::string_view standard;  // default value for the help; may be empty
  std::string_view help;
  std::string_view commands;  // commands that accept it, each followed by a blank: "open check "
  /// Sets the value in the options of one of these commands. Returns the expected form if it is wrong.
  std::optional<std::string> (*set)(CommandOptions& options, const std::string& value);
  bool repeats = false;  // may be given several times
};
[[nodiscard]] std::span<const OptionRow> option_rows();
/// Returns true if the argument is optional; its value is empty if it is omitted.
[[nodiscard]] constexpr bool has_optional_value(const OptionRow& row) { return row.argument.starts_with("[="); }

/// Functions of a command.
struct CommandCalls {
  std::unique_ptr<CommandOptions> (*defaults)();
  int (*run)(const CommandOptions& options);
  /// Checks combinations of options that are valid one by one. Returns the problem, or nullopt.
  std::optional<std::string> (*check)(const CommandOptions& options);
};

/// Command. The first row, "open", is used if the command line names no command.
struct CommandRow {
  std::string_view name;
  std::string_view arguments;  // "FILE..."
  std::string_view help;
  std::size_t least_files, most_files;
  CommandCalls calls;
  bool writes_last = false;  // the last file is written
};
[[nodiscard]] std::span<const CommandRow> command_rows();

/// Returns true if the command accepts the option.
[[nodiscard]] bool accepts(const CommandRow& command, const OptionRow& option);

}  // namespace gs::app
