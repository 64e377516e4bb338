#include "app/commands/options/command_line.h"

#include "app/base/confinement.h"
#include "app/base/console.h"
#include "app/base/temporary_file.h"
#include "app/commands/options/commands.h"
#include "app/commands/options/options.h"
#include "app/commands/options/shared.h"
#include "app/formats/content_types.h"
#include "app/script/script_runner.h"
#include "app/settings/user_settings.h"
#include "app/view/actions.h"
#include "net/files/standard_input.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <unistd.h>

namespace gs::app {
namespace {

bool applies(const OptionRow& option, const CommandRow& command) {
  return option.commands.find(std::string(command.name) + ' ') != std::string_view::npos;
}

void add_options(CLI::App& parser, const CommandRow& command, Options& options) {
  for (const OptionRow& row : option_rows()) {
    if (!applies(row, command)) continue;
    const auto take = [&options, &row](const std::string& value) {
      if (const auto problem = row.set(options, value))
        throw CLI::ValidationError(std::string(row.name), *problem + ", not '" + value + "'");
    };
    std::string help(row.help);
    if (!row.standard.empty()) help += " [" + std::string(row.standard) + "]";
    if (row.argument.empty()) {
      parser.add_flag_callback(
          std::string(row.name), [take] { take(""); }, help);
    } else if (has_optional_value(row)) {
      // The value must follow "=", because the next word is an argument of its own.
      static constexpr std::string_view kAlone = "true";
      parser.add_flag(std::string(row.name), std::as_const(help))
          ->type_name(std::string(row.argument))
          ->each([&options, &row](const std::string& value) {
            // The parser adds the name of the option.
            if (const auto problem = row.set(options, value == kAlone ? "" : value))
              throw CLI::ValidationError(*problem + ", not '" + value + "'");
          });
    } else {
      parser.add_option_function<std::string>(std::string(row.name), take, help)
          ->type_name(std::string(row.argument))
          ->expected(1)
          ->trigger_on_parse(row.repeats);
    }
  }
  if (command.most_files > 0) parser.add_option("files", options.files, "")->type_name("")->group("");
}

// Returns the file that a command writes, or an empty string.
std::string output_of(const Options& options, const CommandRow& command) {
  if (!options.snapshot.empty()) return options.snapshot;
  const bool writes = command.run == run_encode || command.run == run_export;
  return writes ? options.files.back() : std::string();
}

// Returns all files that a command writes to paths from the user.
std::vector<std::string> written_files(const Options& options, const CommandRow& command) {
  std::vector<std::string> files{output_of(options, command), options.sound};
  if (command.run == run_animate) files.push_back(options.files.back());
  return files;
}

std::string folder_of(const std::string& file) {
  if (file.empty()) return {};
  const std::size_t slash = file.rfind('/');
  return slash == std::string::npos ? "." : file.substr(0, slash + 1);
}

// Returns an error for a first argument that is a plain word, but neither a command nor a file. Otherwise returns
// nullopt.
std::optional<std::string> unknown_word(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_';
  });
  std::error_code error;
  if (!plain || word == net::kStandardInput || std::filesystem::exists(word, error)) return std::nullopt;
  std::string names;
  for (const CommandRow& command : command_rows().subspan(1))
    names += (names.empty() ? "" : ", ") + std::string(command.name);
  return "not a file or command; expected a file, a URL or one of " + names;
}

// Replaces "-" among the inputs by standard input. Returns the problem, or nullopt.
std::optional<std::string> take_standard_input(Options& options, const CommandRow& command) {
  const bool writes = command.run == run_encode || command.run == run_export;
  const std::span<std::string> inputs = std::span(options.files).first(options.files.size() - (writes ? 1 : 0));
  const auto count = std::count(inputs.begin(), inputs.end(), net::kStandardInput);
  if (count == 0) return std::nullopt;
  if (count > 1) return "standard input can be used only once";
  std::replace(inputs.begin(), inputs.end(), std::string(net::kStandardInput), std::string(net::kStandardInputPath));
  return net::hold_standard_input(options.limits.memory);
}

int parse_and_run(int count, char** arguments) {
  Options options;
  CLI::App parser("GhostSpace: a browser for VRML97 worlds and 3D models");
  parser.name("ghostspace");
  parser.set_version_flag("--version", "ghostspace " GHOSTSPACE_VERSION);
  parser.footer("Formats, also compressed with gzip: " + content_type_list() +
                ".\nExit status: 0 success, 1 a file cannot be read or drawn or has errors, 2 wrong usage, 3 output "
                "cannot be written.");
  const CommandRow* chosen = &command_rows().front();
  add_options(parser, command_rows().front(), options);
  std::vector<std::pair<CLI::App*, const CommandRow*>> subcommands;
  for (const CommandRow& command : command_rows().subspan(1)) {
    CLI::App* sub = parser.add_subcommand(
        std::string(command.name),
        std::string(command.help) + (command.arguments.empty() ? "" : ": " + std::string(command.arguments)));
    add_options(*sub, command, options);
    subcommands.emplace_back(sub, &command);
  }
  try {
    parser.parse(count, arguments);
    for (const auto& [sub, command] : subcommands)
      if (sub->parsed()) chosen = command;
    if (options.files.size() < chosen->least_files || options.files.size() > chosen->most_files)
      throw CLI::ValidationError(std::string(chosen->name), "expected " + std::string(chosen->arguments));
    if (chosen == &command_rows().front() && !options.files.empty())
      if (const auto problem = unknown_word(options.files.front()))
        throw CLI::ValidationError(options.files.front(), *problem);
    if (!options.snapshot.empty() && options.files.size() > 1)
      throw CLI::ValidationError("--snapshot", "expected one file");
    if ((options.time > 0 || !options.input.empty() || options.press_sensors) && chosen == &command_rows().front() &&
        options.snapshot.empty())
      throw CLI::ValidationError("--time, --input and --press-sensors", "expected with --snapshot");
    const bool controlled = !options.control_paths.empty() || !options.control_ports.empty();
    if (controlled && !options.snapshot.empty())
      throw CLI::ValidationError("--control", "expected without --snapshot; clients can request pictures");
    if (!controlled && !options.control_token.empty())
      throw CLI::ValidationError("--control-token", "expected with --control");
    if (!options.confine.empty() && chosen == &command_rows().front() && options.snapshot.empty())
      throw CLI::ValidationError("--confine", "a window needs wider access; expected --snapshot");
    if (chosen->check)
      if (const auto problem = chosen->check(options)) throw CLI::ValidationError(std::string(chosen->name), *problem);
  } catch (const CLI::Success& help) {
    std::ostringstream text;
    const int status = parser.exit(help, text, text);
    print_text(text.str());
    return status;
  } catch (const CLI::ParseError& problem) {
    complain("ghostspace: %s", problem.what());
    complain("See 'ghostspace --help'.");
    return kUsage;
  }
  remove_abandoned_files();
  for (const std::string& file : written_files(options, *chosen)) remove_unfinished_beside(file);
  if (const auto problem = take_standard_input(options, *chosen)) return fail(*problem);
  if (!options.confine.empty())
    if (const auto problem = confine({options.confine, folder_of(output_of(options, *chosen))})) return fail(*problem);
  return chosen->run(options);
}

constexpr char kNoMemory[] = "ghostspace: error: not enough memory";

// Handles an uncaught exception of any thread. Prints one line; if memory ran out, exits instead of crashing.
[[noreturn]] void end_at_exception() {
  const std::exception_ptr exception = std::current_exception();
  try {
    if (exception) std::rethrow_exception(exception);
  } catch (const std::bad_alloc&) {
    (void)!::write(STDERR_FILENO, kNoMemory, sizeof kNoMemory - 1);
    (void)!::write(STDERR_FILENO, "\n", 1);
    ::_exit(kFailed);
  } catch (const std::exception& problem) {
    complain("ghostspace: error: %s", problem.what());
  }
  std::abort();
}

// Escapes text for roff: dashes, and a first character that would start a command.
std::string escaped(std::string_view text) {
  std::string result = "\\&";
  for (const char c : text) {
    if (c == '-' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

}  // namespace

std::string manual_page() {
  std::string out =
      ".TH GHOSTSPACE 1\n.SH NAME\nghostspace \\- browser for VRML97 worlds and 3D models\n.SH SYNOPSIS\n";
  for (const CommandRow& command : command_rows())
    out += ".B ghostspace" + (command.name == "open" ? std::string() : " " + std::string(command.name)) +
           "\n[options] " + std::string(command.arguments) + "\n.br\n";
  for (const CommandRow& command : command_rows()) {
    out += ".SH " + std::string(command.name) + "\n" + std::string(command.help) + ".\n";
    for (const OptionRow& row : option_rows()) {
      if (!applies(row, command)) continue;
      std::string name(row.name);
      for (std::size_t i = 0; (i = name.find('-', i)) != std::string::npos; i += 2) name.replace(i, 1, "\\-");
      out += ".TP\n.B " + name + (row.argument.empty() || has_optional_value(row) ? "" : " ") +
             std::string(row.argument) + "\n" + std::string(row.help);
      if (!row.standard.empty()) out += " (" + std::string(row.standard) + ")";
      out += ".\n";
    }
  }
  out += ".SH FILES\nInput, also compressed with gzip: " + content_type_list() +
         ".\n.PP\nOutput of export: " + export_format_list() + ".\n";
  out += ".SH KEYS\nActions in a window. F1 also lists the keys that move the viewer.\n";
  for (const ActionRow& row : actions())
    if (const std::string keys = keys_of(row); !keys.empty())
      out += ".TP\n.B " + escaped(keys) + "\n" + std::string(row.help) + ".\n";
  out +=
      ".SH SETTINGS\nLines NAME = VALUE in $XDG_CONFIG_HOME/ghostspace/settings.conf (default "
      "~/.config/ghostspace/settings.conf) or in the file of \\-\\-config. The preferences write them. Bookmarks are "
      "stored in the same folder, other state and the log in $XDG_STATE_HOME/ghostspace.\n";
  for (const SettingRow& row : setting_rows())
    out += ".TP\n.B " + escaped(row.name) + "\n" + std::string(row.help) + " (" + standard_of(row) + ").\n";
  out +=
      ".SH EXIT STATUS\n0: success. 1: a file cannot be read or drawn, or has errors. 2: wrong usage. 3: output cannot "
      "be written, for example on a full disk.\n";
  return out;
}

int run_command_line(int count, char** arguments) {
  prepare_console();
  // Exceeding the file size limit becomes a write error, like a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  std::set_terminate(end_at_exception);
  // Commands without a window end when a Script hangs; windows wait for the user (EndOverdueScripts).
  ScriptRunner::on_overdue([](const std::string& message) {
    complain("%s; it cannot be interrupted, so the command exits", message.c_str());
    std::_Exit(kFailed);
  });
  int status = kFailed;
  try {
    status = parse_and_run(count, arguments);
  } catch (const std::bad_alloc&) {
    complain("%s", kNoMemory);
  } catch (const std::length_error&) {  // from a vector larger than the address space
    complain("%s", kNoMemory);
  } catch (const std::exception& problem) {
    complain("ghostspace: error: %s", problem.what());
  }
  if (const auto problem = finish_output()) {
    complain("ghostspace: error: %s", problem->c_str());
    if (status == kDone) status = kNotWritten;
  }
  return status;
}

}  // namespace gs::app
