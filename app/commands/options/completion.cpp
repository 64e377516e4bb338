#include "app/commands/options/desktop_files.h"
#include "app/commands/options/options.h"
#include "app/formats/content_types.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

// Completion of command lines in shells. The tables of options and commands are its source.
namespace gs::app {
namespace {

bool is_lower(char c) { return c >= 'a' && c <= 'z'; }

enum class ValueKind : std::uint8_t { none, words, file, folder, other };

// Returns the kind of an option's value, which the name of its argument in the help shows.
ValueKind value_kind_of(const OptionRow& row) {
  const std::string_view value = row.argument;
  if (value.empty() || has_optional_value(row)) return ValueKind::none;
  if (value.find('|') != std::string_view::npos && std::any_of(value.begin(), value.end(), is_lower))
    return ValueKind::words;
  for (const std::string_view file : {"FILE", "OUT.", "PATH"})
    if (value.starts_with(file)) return ValueKind::file;
  return value.starts_with("FOLDER") ? ValueKind::folder : ValueKind::other;
}

// Returns the words that an option accepts. Names of other values, such as BITS, are left out.
std::string words_of(const OptionRow& row, char between) {
  std::string words;
  std::string_view rest = row.argument;
  while (!rest.empty()) {
    const std::string_view word = rest.substr(0, rest.find('|'));
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
    if (std::any_of(word.begin(), word.end(), is_lower))
      words += (words.empty() ? "" : std::string(1, between)) + std::string(word);
  }
  return words;
}

// Returns the file name extensions of all types that can be opened: "wrl", "wrz", ...
std::vector<std::string> extensions() {
  std::set<std::string> all;
  for (const ContentType& type : content_types()) {
    std::string_view rest = type.extensions;
    while (!rest.empty()) {
      const std::size_t end = rest.find(' ');
      all.insert(std::string(rest.substr(1, end - 1)));
      rest.remove_prefix(end + 1);
    }
  }
  all.insert("gslink");
  return {all.begin(), all.end()};
}

std::string joined(const std::vector<std::string>& parts, std::string_view between) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : std::string(between)) + part;
  return text;
}

std::string command_names(std::string_view between) {
  std::vector<std::string> names;
  for (const CommandRow& command : command_rows().subspan(1)) names.emplace_back(command.name);
  return joined(names, between);
}

std::string option_names(const CommandRow& command) {
  std::vector<std::string> names{"--help"};
  if (&command == &command_rows().front()) names.emplace_back("--version");
  for (const OptionRow& row : option_rows())
    if (accepts(command, row) && !row.former) names.emplace_back(row.name);
  return joined(names, " ");
}

// Escapes text for use between single quotes in a shell.
std::string quoted_help(std::string_view text, std::string_view apostrophe, std::string_view marked = {}) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += apostrophe;
      continue;
    }
    if (marked.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

std::string bash_completion() {
  std::string text =
      "# Completion of ghostspace for bash, made of its table of options.\n_ghostspace() {\n"
      "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command='' word\n"
      "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n    case $word in\n      " +
      command_names(" | ") +
      ")\n        command=$word\n        break\n        ;;\n    esac\n  done\n  COMPREPLY=()\n  case $previous in\n";
  for (const OptionRow& row : option_rows()) {
    const ValueKind kind = value_kind_of(row);
    if (kind == ValueKind::none || row.former) continue;
    text += "    " + std::string(row.name) + ")\n";
    if (kind == ValueKind::words)
      text += "      mapfile -t COMPREPLY < <(compgen -W '" + words_of(row, ' ') + "' -- \"$current\")\n";
    if (kind == ValueKind::file)
      text += "      compopt -o filenames\n      mapfile -t COMPREPLY < <(compgen -f -- \"$current\")\n";
    if (kind == ValueKind::folder)
      text += "      compopt -o filenames\n      mapfile -t COMPREPLY < <(compgen -d -- \"$current\")\n";
    text += "      return\n      ;;\n";
  }
  text += "  esac\n  if [[ $current == -* ]]; then\n    local options=''\n    case $command in\n";
  for (const CommandRow& command : command_rows()) {
    const bool first = &command == &command_rows().front();
    text += "      " + (first ? std::string("''") : std::string(command.name)) + ") options='" + option_names(command) +
            "' ;;\n";
  }
  text +=
      "    esac\n    mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$current\")\n    return\n  fi\n"
      "  compopt -o filenames\n  mapfile -t COMPREPLY < <(\n    [[ -n $command ]] || compgen -W '" +
      command_names(" ") +
      "' -- \"$current\"\n    compgen -d -- \"$current\"\n    shopt -s extglob nocasematch\n"
      "    while IFS= read -r word; do\n      [[ -d $word || $word != *.@(" +
      joined(extensions(), "|") +
      ")?(.gz) ]] || printf '%s\\n' \"$word\"\n    done < <(compgen -f -- \"$current\")\n  )\n}\n" +
      "complete -F _ghostspace ghostspace\n";
  return text;
}

std::string zsh_completion() {
  constexpr std::string_view kMarked = "[]:\\";
  std::string text = "#compdef ghostspace\n# Completion of ghostspace for zsh, made of its table of options.\n";
  const auto value_of = [&](const OptionRow& row) -> std::string {
    const std::string name = quoted_help(row.argument, "", kMarked);
    switch (value_kind_of(row)) {
      case ValueKind::none:
        return {};
      case ValueKind::words:
        return ":" + std::string(row.name.substr(2)) + ":(" + words_of(row, ' ') + ")";
      case ValueKind::file:
        return ":" + name + ":_files";
      case ValueKind::folder:
        return ":" + name + ":_files -/";
      case ValueKind::other:
        break;
    }
    return ":" + name + ": ";
  };
  text += "_ghostspace() {\n  local command=${words[(r)(" + command_names("|") + ")]}\n  local -a options files\n" +
          "  files=('*:file:_files -g \"(#i)*.(" + joined(extensions(), "|") + ")(|.gz)\"')\n  case $command in\n";
  for (const CommandRow& command : command_rows().subspan(1)) {
    text += "    " + std::string(command.name) + ")\n      options=('--help[show what it takes]'\n";
    for (const OptionRow& row : option_rows())
      if (accepts(command, row) && !row.former)
        text += "        '" + std::string(row.repeats ? "*" : "") + std::string(row.name) + "[" +
                quoted_help(row.help, "'\\''", kMarked) + "]" + value_of(row) + "'\n";
    text += "      )\n      ;;\n";
  }
  text += "    *)\n      options=('--help[show what it takes]' '--version[show the version]'\n";
  for (const OptionRow& row : option_rows())
    if (accepts(command_rows().front(), row) && !row.former)
      text += "        '" + std::string(row.repeats ? "*" : "") + std::string(row.name) + "[" +
              quoted_help(row.help, "'\\''", kMarked) + "]" + value_of(row) + "'\n";
  text +=
      "      )\n      files=('1:command or file:_ghostspace_first' $files)\n      ;;\n  esac\n"
      "  _arguments -s $options $files\n}\n_ghostspace_first() {\n  local -a commands\n  commands=(\n";
  for (const CommandRow& command : command_rows().subspan(1))
    text += "    '" + std::string(command.name) + ":" + quoted_help(command.help, "'\\''", kMarked) + "'\n";
  return text + "  )\n  _describe command commands\n  _files -g \"(#i)*.(" + joined(extensions(), "|") +
         ")(|.gz)\"\n}\n_ghostspace \"$@\"\n";
}

std::string fish_completion() {
  std::string text = "# Completion of ghostspace for fish, made of its table of options.\n";
  const std::string none = "not __fish_seen_subcommand_from " + command_names(" ");
  for (const CommandRow& command : command_rows()) {
    const bool first = &command == &command_rows().front();
    const std::string when = first ? none : "__fish_seen_subcommand_from " + std::string(command.name);
    if (!first)
      text += "complete -c ghostspace -n '" + none + "' -a " + std::string(command.name) + " -d '" +
              quoted_help(command.help, "\\'", "\\") + "'\n";
    for (const OptionRow& row : option_rows()) {
      if (!accepts(command, row) || row.former) continue;
      const ValueKind kind = value_kind_of(row);
      text += "complete -c ghostspace -n '" + when + "' -l " + std::string(row.name.substr(2));
      if (kind == ValueKind::words) text += " -x -a '" + words_of(row, ' ') + "'";
      if (kind == ValueKind::file) text += " -r -F";
      if (kind == ValueKind::folder) text += " -x -a '(__fish_complete_directories)'";
      if (kind == ValueKind::other) text += " -x";
      text += " -d '" + quoted_help(row.help, "\\'", "\\") + "'\n";
    }
  }
  return text;
}

}  // namespace gs::app
