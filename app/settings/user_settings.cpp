#include "app/settings/user_settings.h"

#include "app/base/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <system_error>

namespace gs::app {
namespace {

constexpr std::size_t kMostProblems = 20;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::optional<double> read_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string text_of_number(double value) {
  char buffer[64];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return error == std::errc() ? std::string(buffer, end) : std::string("0");
}

double number_in(std::string_view text) { return read_number(text).value_or(0); }
std::string on_off(bool value) { return value ? "on" : "off"; }

constexpr auto kFlag = SettingRow::Kind::flag, kNumber = SettingRow::Kind::number, kChoice = SettingRow::Kind::choice;
constexpr std::string_view kOnOff = "on off ";
constexpr double kMostVectors = 1e9;

constexpr SettingRow kSettings[] = {
    {"theme", "Colours", kChoice, "dark light ", 0, 0, false, "dark or light colours of the window",
     [](const UserSettings& s) { return std::string(s.theme == Theme::dark ? "dark" : "light"); },
     [](UserSettings& s, std::string_view v) { s.theme = v == "light" ? Theme::light : Theme::dark; }},
    {"text-size", "Size of text", kNumber, "", 0.7, 2.5, false, "size of text and buttons: 1 is what the screen has",
     [](const UserSettings& s) { return text_of_number(s.text_size); },
     [](UserSettings& s, std::string_view v) { s.text_size = number_in(v); }},
    {"speed", "Speed", kNumber, "", 0.01, 100, false, "how fast you move: 1 is what worlds say",
     [](const UserSettings& s) { return text_of_number(s.speed); },
     [](UserSettings& s, std::string_view v) { s.speed = number_in(v); }},
    {"sound", "Sound", kFlag, kOnOff, 0, 0, false, "sound is on when a window opens",
     [](const UserSettings& s) { return on_off(s.sound); },
     [](UserSettings& s, std::string_view v) { s.sound = v == "on"; }},
    {"system-dialog", "Open by the desktop's dialog", kFlag, kOnOff, 0, 0, false,
     "files are chosen in the dialog of the desktop, where it has one",
     [](const UserSettings& s) { return on_off(s.system_dialog); },
     [](UserSettings& s, std::string_view v) { s.system_dialog = v == "on"; }},
    {"restore", "Offer to restore", kFlag, kOnOff, 0, 0, false,
     "offer to open the files of a window that ended unexpectedly",
     [](const UserSettings& s) { return on_off(s.offers_to_restore); },
     [](UserSettings& s, std::string_view v) { s.offers_to_restore = v == "on"; }},
    {"log-file", "Keep a log", kFlag, kOnOff, 0, 0, false, "write what the Log panel says into a file as well",
     [](const UserSettings& s) { return on_off(s.writes_log); },
     [](UserSettings& s, std::string_view v) { s.writes_log = v == "on"; }},
    {"up", "What is up", kChoice, "auto x -x y -y z -z ", 0, 0, false,
     "in files that are opened; auto: as the file says, or as its format has it; --up counts before it",
     [](const UserSettings& s) { return std::string(name_of(s.up)); },
     [](UserSettings& s, std::string_view v) { s.up = find_up_axis(v).value_or(UpAxis::automatic); }},
    {"backdrop", "Gradient behind things", kFlag, kOnOff, 0, 0, false,
     "behind meshes, volumes and splats; VRML97 worlds have the background that their authors gave them, or black",
     [](const UserSettings& s) { return on_off(s.backdrop); },
     [](UserSettings& s, std::string_view v) { s.backdrop = v == "on"; }},
    {"axes", "Axes in a corner", kFlag, kOnOff, 0, 0, false,
     "of meshes, volumes and splats: a click on one shows that side",
     [](const UserSettings& s) { return on_off(s.axes); },
     [](UserSettings& s, std::string_view v) { s.axes = v == "on"; }},
    {"first-steps", "First steps", kFlag, kOnOff, 0, 0, false, "what to do first, in three lines over the demo world",
     [](const UserSettings& s) { return on_off(s.first_steps); },
     [](UserSettings& s, std::string_view v) { s.first_steps = v == "on"; }},
    {"memory", "Memory of a world", kNumber, "", 0.25, 1024, false,
     "about so many GiB may be taken for a file that is opened; what would take more is left out; --memory counts "
     "before "
     "it",
     [](const UserSettings& s) { return text_of_number(s.memory); },
     [](UserSettings& s, std::string_view v) { s.memory = number_in(v); }},
    {"budget", "Detail of clouds", kNumber, "", 0, kMostVectors, true,
     "most vectors that a window draws; 0: what suits most machines; --budget counts before it",
     [](const UserSettings& s) { return std::to_string(s.budget); },
     [](UserSettings& s, std::string_view v) { s.budget = static_cast<std::size_t>(number_in(v)); }},
};

// Returns the expected values of a row, such as "dark or light".
std::string expected_by(const SettingRow& row) {
  if (row.kind == kNumber)
    return std::string(row.whole ? "a whole number from " : "a number from ") + text_of_number(row.least) + " to " +
           text_of_number(row.most);
  std::string text;
  for (std::size_t at = 0; at < row.choices.size();) {
    const std::size_t end = row.choices.find(' ', at);
    text.append(text.empty() ? "" : " or ").append(row.choices.substr(at, end - at));
    at = end + 1;
  }
  return text;
}

}  // namespace

std::span<const SettingRow> setting_rows() { return kSettings; }

const SettingRow* find_setting(std::string_view name) {
  const auto row = std::find_if(std::begin(kSettings), std::end(kSettings),
                                [name](const SettingRow& one) { return one.name == name; });
  return row == std::end(kSettings) ? nullptr : &*row;
}

std::string standard_of(const SettingRow& row) { return row.get(UserSettings{}); }

std::optional<std::string> set_setting(UserSettings& settings, const SettingRow& row, std::string_view text) {
  const std::optional<double> number = row.kind == kNumber ? read_number(text) : std::nullopt;
  const bool good =
      row.kind == kNumber
          ? number && *number >= row.least && *number <= row.most && (!row.whole || *number == std::floor(*number))
          : !text.empty() && text.find(' ') == std::string_view::npos &&
                (" " + std::string(row.choices)).find(" " + std::string(text) + " ") != std::string::npos;
  if (!good) return "expected " + expected_by(row);
  row.set(settings, text);
  return std::nullopt;
}

ReadSettings read_settings(std::string_view text) {
  ReadSettings result;
  std::size_t line = 0;
  const auto complain_of = [&](const std::string& what) {
    if (result.problems.size() < kMostProblems) result.problems.push_back(std::to_string(line) + ": error: " + what);
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view whole = trimmed(text.substr(at, end - at));
    at = end + 1;
    ++line;
    if (whole.empty() || whole.front() == '#') continue;
    const std::size_t sign = whole.find('=');
    if (sign == std::string_view::npos) {
      complain_of("\"" + shortened(whole, 60) + "\": expected name = value");
      continue;
    }
    const std::string_view name = trimmed(whole.substr(0, sign)), value = trimmed(whole.substr(sign + 1));
    const SettingRow* row = find_setting(name);
    if (!row)
      complain_of("there is no setting \"" + shortened(name, 60) + "\"");
    else if (const auto problem = set_setting(result.settings, *row, value))
      complain_of(std::string(row->name) + " = \"" + shortened(value, 60) + "\": " + *problem);
  }
  return result;
}

std::string settings_text(const UserSettings& settings) {
  std::string text =
      "# Settings of GhostSpace: name = value. The preferences of its window (Ctrl+,) write this file.\n";
  for (const SettingRow& row : kSettings) {
    const std::string value = row.get(settings);
    text += "\n# " + std::string(row.help) + ": " + expected_by(row) + "\n";
    text += (value == standard_of(row) ? "#" : "") + std::string(row.name) + " = " + value + "\n";
  }
  return text;
}

}  // namespace gs::app
