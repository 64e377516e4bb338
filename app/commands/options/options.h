#pragma once

#include "app/commands/common/option_groups.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// Option. The parser, --help and the manual page are derived from these rows.
struct OptionRow {
  std::string_view name;      // "--size"
  std::string_view argument;  // "WxH"; empty for a flag; "[=BITS]" if it is optional
  std::string_view standard;  // default value as text for the help; may be empty
  std::string_view help;
  std::string_view commands;  // commands that accept it, each followed by a blank: "open check "
  /// Sets the value in `options`, which belong to a command with this option. If the value is wrong, returns the
  /// expected form, else nullopt.
  std::optional<std::string> (*set)(CommandOptions& options, const std::string& value);
  bool repeats = false;  // true if the option may occur several times
  bool former = false;   // true for a former spelling: accepted, but not listed
};
[[nodiscard]] std::span<const OptionRow> option_rows();
/// Returns true if the option's argument may be omitted. Its value is then empty.
[[nodiscard]] constexpr bool has_optional_value(const OptionRow& row) { return row.argument.starts_with("[="); }

/// Functions of a command.
struct CommandCalls {
  std::unique_ptr<CommandOptions> (*defaults)();
  int (*run)(const CommandOptions& options);
  /// Checks the options of the command together. Each one alone is valid. Returns an error, or nullopt.
  std::optional<std::string> (*check)(const CommandOptions& options);
};

/// Command. The first row, "open", is the default for command lines without the name of a command.
struct CommandRow {
  std::string_view name;
  std::string_view arguments;  // "FILE..."
  std::string_view help;
  std::size_t least_files, most_files;
  CommandCalls calls;
  bool writes_last = false;  // true if the last file is the output
};
[[nodiscard]] std::span<const CommandRow> command_rows();

/// Returns true if the command accepts the option.
[[nodiscard]] bool accepts(const CommandRow& command, const OptionRow& option);

}  // namespace gs::app
