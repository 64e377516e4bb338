#include "app/commands/options/command_line.h"

#include "app/base/confinement.h"
#include "app/base/console.h"
#include "app/base/environment.h"
#include "app/base/temporary_file.h"
#include "app/commands/common/shared.h"
#include "app/commands/open.h"
#include "app/commands/options/options.h"
#include "app/confined/decoder_child.h"
#include "app/confined/decoder_pool.h"
#include "app/formats/confined/confined_import.h"
#include "app/formats/content_types.h"
#include "app/formats/datasets/dataset_formats.h"
#include "app/formats/volume/confined/confined_volume.h"
#include "app/script/process/program_child.h"
#include "app/script/process/program_process.h"
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
#include <memory>
#include <new>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <unistd.h>

namespace gs::app {
namespace {

// Command with its CLI11 parser and the values of its options.
struct ParsedCommand {
  const CommandRow& row;
  CLI::App* parser;
  std::unique_ptr<CommandOptions> options;
};

// Sets an option of a command. An option before the command's name belongs to the first command row ("open"). It is
// also set for all other commands that accept it.
std::optional<std::string> set_option(const std::vector<ParsedCommand>& commands, const CommandRow& command,
                                      const OptionRow& row, const std::string& value) {
  std::optional<std::string> problem;
  for (const ParsedCommand& each : commands)
    if (&each.row == &command || (&command == &command_rows().front() && accepts(each.row, row)))
      if (auto wrong = row.set(*each.options, value)) problem = std::move(wrong);
  return problem;
}

void add_options(const ParsedCommand& command, const std::vector<ParsedCommand>& commands) {
  CLI::App& parser = *command.parser;
  for (const OptionRow& row : option_rows()) {
    if (!accepts(command.row, row)) continue;
    const auto take = [&commands, &taker = command.row, &row](const std::string& value) {
      if (const auto problem = set_option(commands, taker, row, value))
        throw CLI::ValidationError(std::string(row.name), *problem + ", not '" + value + "'");
    };
    std::string help(row.help);
    if (!row.standard.empty()) help += " [" + std::string(row.standard) + "]";
    if (row.argument.empty()) {
      CLI::Option* const option = parser.add_flag_callback(
          std::string(row.name), [take] { take(""); }, help);
      if (row.former) option->group("");
    } else if (has_optional_value(row)) {
      // An optional value must follow "=", because the next word is a separate argument.
      static constexpr std::string_view kAlone = "true";
      CLI::Option* const option = parser.add_flag(std::string(row.name), std::as_const(help));
      if (row.former) option->group("");
      option->type_name(std::string(row.argument))
          ->each([&commands, &taker = command.row, &row](const std::string& value) {
            // The parser adds the name of the option to the message.
            if (const auto problem = set_option(commands, taker, row, value == kAlone ? "" : value))
              throw CLI::ValidationError(*problem + ", not '" + value + "'");
          });
    } else {
      parser.add_option_function<std::string>(std::string(row.name), take, help)
          ->type_name(std::string(row.argument))
          ->expected(1)
          ->trigger_on_parse(row.repeats);
    }
  }
  if (command.row.most_files > 0) parser.add_option("files", command.options->files, "")->type_name("")->group("");
}

// Returns the path of the output file of a command, or an empty string.
std::string output_of(const CommandRow& command, const CommandOptions& options) {
  if (command.writes_last) return options.files.back();
  const auto* open = dynamic_cast<const OpenCommand*>(&options);
  return open ? open->snapshot : std::string();
}

// Returns the paths of all files that a command writes and that the user has named. Paths may be empty.
std::vector<std::string> written_files(const CommandRow& command, const CommandOptions& options) {
  const auto* simulation = dynamic_cast<const SimulationOptions*>(&options);
  return {output_of(command, options), simulation ? simulation->sound : std::string()};
}

std::string folder_of(const std::string& file) {
  if (file.empty()) return {};
  const std::size_t slash = file.rfind('/');
  return slash == std::string::npos ? "." : file.substr(0, slash + 1);
}

// Returns an error if the first argument is a plain word, but neither a command nor a file. Otherwise returns nullopt.
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

// Replaces "-" by standard input in the list of input files. Returns an error, or nullopt.
std::optional<std::string> take_standard_input(const CommandRow& command, CommandOptions& options) {
  const std::span<std::string> inputs =
      std::span(options.files).first(options.files.size() - (command.writes_last ? 1 : 0));
  const auto count = std::count(inputs.begin(), inputs.end(), net::kStandardInput);
  if (count == 0) return std::nullopt;
  if (count > 1) return "standard input can be used only once";
  std::replace(inputs.begin(), inputs.end(), std::string(net::kStandardInput), std::string(net::kStandardInputPath));
  const auto* loading = dynamic_cast<const LoadingOptions*>(&options);
  return net::hold_standard_input((loading ? loading->limits : Limits{}).memory);
}

// Throws a usage error if the number of files or a combination of options is wrong.
void check_usage(const CommandRow& command, const CommandOptions& options) {
  const bool is_open = &command == &command_rows().front();
  if (options.files.size() < command.least_files || options.files.size() > command.most_files)
    throw CLI::ValidationError(std::string(command.name), "expected " + std::string(command.arguments));
  if (is_open && !options.files.empty())
    if (const auto problem = unknown_word(options.files.front()))
      throw CLI::ValidationError(options.files.front(), *problem);
  if (const auto problem = command.calls.check(options))
    throw CLI::ValidationError(is_open ? *problem : std::string(command.name) + ": " + *problem);
}

int run_command(const CommandRow& command, CommandOptions& options) {
  remove_abandoned_files();
  for (const std::string& file : written_files(command, options)) remove_unfinished_beside(file);
  if (const auto problem = take_standard_input(command, options)) return fail(*problem);
  if (const auto* loading = dynamic_cast<const LoadingOptions*>(&options); loading && !loading->confine.empty()) {
    set_decoder_program({});  // this process is confined itself, and can start no other
    script::set_program_of_scripts({});
    for (const std::string& file : options.files) prepare_datasets(file);
    if (const auto problem = confine({loading->confine, folder_of(output_of(command, options))})) return fail(*problem);
  }
  return command.calls.run(options);
}

int parse_and_run(int count, char** arguments) {
  CLI::App parser("GhostSpace: a browser for VRML97 worlds and 3D models");
  parser.name("ghostspace");
  parser.set_version_flag("--version", "ghostspace " GHOSTSPACE_VERSION);
  parser.footer("Formats, also compressed with gzip: " + content_type_list() +
                ".\nExit status: 0 success, 1 a file cannot be read or drawn or has errors, 2 wrong usage, 3 output "
                "cannot be written.");
  std::vector<ParsedCommand> commands;
  for (const CommandRow& row : command_rows()) {
    CLI::App* const own =
        commands.empty()
            ? &parser
            : parser.add_subcommand(std::string(row.name), std::string(row.help) + (row.arguments.empty() ? "" : ": ") +
                                                               std::string(row.arguments));
    commands.push_back({row, own, row.calls.defaults()});
  }
  for (const ParsedCommand& command : commands) add_options(command, commands);
  try {
    parser.parse(count, arguments);
    const auto chosen = std::find_if(commands.begin() + 1, commands.end(),
                                     [](const ParsedCommand& command) { return command.parser->parsed(); });
    const ParsedCommand& command = chosen == commands.end() ? commands.front() : *chosen;
    check_usage(command.row, *command.options);
    return run_command(command.row, *command.options);
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
}

constexpr char kNoMemory[] = "ghostspace: error: not enough memory";

// Ends the program after an uncaught exception in any thread. Prints one line. If memory is exhausted, exits without a
// core dump.
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

// Escapes text for roff. Escapes dashes, and a first character that would begin a roff request.
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
      if (!accepts(command, row) || row.former) continue;
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
    if (const std::string keys = all_keys_of(row); !keys.empty())
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

int run_man(const CommandOptions&) {
  print_text(manual_page());
  return kDone;
}

bool is_child_call(int count, char** arguments) {
  return (count == 4 && arguments[1] == kDecoderArgument) || (count == 3 && arguments[1] == script::kProgramsArgument);
}

int run_command_line(int count, char** arguments) {
  if (count == 4 && arguments[1] == kDecoderArgument)
    run_decoder_child(arguments[2], arguments[3], {import_in_child, volume_of_child, load_datasets});
  if (count == 3 && arguments[1] == script::kProgramsArgument) script::run_program_child(arguments[2]);
  set_decoder_program("/proc/self/exe");
  script::set_program_of_scripts("/proc/self/exe");
  prepare_console();
  // Without the signal, writing beyond the file size limit fails like writing to a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  spare_full_disk();
  std::set_terminate(end_at_exception);
  // A process that is confined itself runs Scripts without a child that it could kill. If one hangs, the process ends.
  ScriptRunner::on_overdue([](const std::string& message) {
    complain("%s; it cannot be interrupted, so the command exits", message.c_str());
    std::_Exit(kFailed);
  });
  int status = kFailed;
  try {
    status = parse_and_run(count, arguments);
  } catch (const std::bad_alloc&) {
    complain("%s", kNoMemory);
  } catch (const std::length_error&) {  // a vector was to become larger than the address space
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
