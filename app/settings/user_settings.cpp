#include "app/settings/user_settings.h"

#include "base/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <system_error>

namespace gs::app {
namespace {

constexpr std::size_t kMaxProblems = 20;

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
constexpr double kMaxVectors = 1e9;

constexpr SettingRow kSettings[] = {
    {"theme", "Colours", kChoice, "dark light ", 0, 0, false, "dark or light theme",
     [](const UserSettings& s) { return std::string(s.theme == Theme::dark ? "dark" : "light"); },
     [](UserSettings& s, std::string_view v) { s.theme = v == "light" ? Theme::light : Theme::dark; }},
    {"text-size", "Text size", kNumber, "", 0.7, 2.5, false, "size of text and buttons; 1 is the default of the screen",
     [](const UserSettings& s) { return text_of_number(s.text_size); },
     [](UserSettings& s, std::string_view v) { s.text_size = number_in(v); }},
    {"speed", "Speed", kNumber, "", 0.01, 100, false, "multiplies the speed that worlds set",
     [](const UserSettings& s) { return text_of_number(s.speed); },
     [](UserSettings& s, std::string_view v) { s.speed = number_in(v); }},
    {"sound", "Sound", kFlag, kOnOff, 0, 0, false, "starts with sound",
     [](const UserSettings& s) { return on_off(s.sound); },
     [](UserSettings& s, std::string_view v) { s.sound = v == "on"; }},
    {"system-dialog", "Desktop file dialog", kFlag, kOnOff, 0, 0, false,
     "uses the file dialog of the desktop, if there is one",
     [](const UserSettings& s) { return on_off(s.system_dialog); },
     [](UserSettings& s, std::string_view v) { s.system_dialog = v == "on"; }},
    {"restore", "Restore after a crash", kFlag, kOnOff, 0, 0, false, "offers to open the files again after a crash",
     [](const UserSettings& s) { return on_off(s.offers_to_restore); },
     [](UserSettings& s, std::string_view v) { s.offers_to_restore = v == "on"; }},
    {"log-file", "Log file", kFlag, kOnOff, 0, 0, false, "writes the entries of the Log panel to a file",
     [](const UserSettings& s) { return on_off(s.writes_log); },
     [](UserSettings& s, std::string_view v) { s.writes_log = v == "on"; }},
    {"up", "Up axis", kChoice, "auto x -x y -y z -z ", 0, 0, false,
     "up axis of opened files; auto uses the axis of the file or format; --up overrides it",
     [](const UserSettings& s) { return std::string(name_of(s.up)); },
     [](UserSettings& s, std::string_view v) { s.up = find_up_axis(v).value_or(UpAxis::automatic); }},
    {"backdrop", "Gradient background", kFlag, kOnOff, 0, 0, false,
     "behind meshes, volumes and splats; VRML97 worlds keep their own background, or black",
     [](const UserSettings& s) { return on_off(s.backdrop); },
     [](UserSettings& s, std::string_view v) { s.backdrop = v == "on"; }},
    {"axes", "Coordinate axes", kFlag, kOnOff, 0, 0, false,
     "in a corner of meshes, volumes and splats; click an axis to view that side",
     [](const UserSettings& s) { return on_off(s.axes); },
     [](UserSettings& s, std::string_view v) { s.axes = v == "on"; }},
    {"first-steps", "First steps", kFlag, kOnOff, 0, 0, false, "shows three lines of help over the demo world",
     [](const UserSettings& s) { return on_off(s.first_steps); },
     [](UserSettings& s, std::string_view v) { s.first_steps = v == "on"; }},
    {"memory", "Memory limit", kNumber, "", 0.25, 1024, false,
     "maximum memory per file in GiB; the excess is left out; --memory overrides it",
     [](const UserSettings& s) { return text_of_number(s.memory); },
     [](UserSettings& s, std::string_view v) { s.memory = number_in(v); }},
    {"budget", "Vector budget", kNumber, "", 0, kMaxVectors, true,
     "maximum number of vectors drawn in a window; 0 chooses automatically; --budget overrides it",
     [](const UserSettings& s) { return std::to_string(s.budget); },
     [](UserSettings& s, std::string_view v) { s.budget = static_cast<std::size_t>(number_in(v)); }},
};

// Returns a description of the valid values of a setting, such as "dark or light".
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
    if (result.problems.size() < kMaxProblems) result.problems.push_back(std::to_string(line) + ": error: " + what);
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
  std::string text = "# Settings of GhostSpace: name = value. The preferences (Ctrl+,) write this file.\n";
  for (const SettingRow& row : kSettings) {
    const std::string value = row.get(settings);
    text += "\n# " + std::string(row.help) + ": " + expected_by(row) + "\n";
    text += (value == standard_of(row) ? "#" : "") + std::string(row.name) + " = " + value + "\n";
  }
  return text;
}

}  // namespace gs::app
