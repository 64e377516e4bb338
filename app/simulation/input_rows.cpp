#include "app/simulation/input_rows.h"

#include "app/view/actions.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

namespace gs::app {
namespace {

using Json = nlohmann::json;

struct LineReader {
  std::string_view line;
  std::uint32_t number;
  const std::string& file;
  Diagnostics& diagnostics;

  // Returns the position of a key in the line. The column counts from 1; it is 1 if the key is written with escapes.
  [[nodiscard]] SourceLocation place_of(std::string_view key) const {
    const std::size_t at = line.find('"' + std::string(key) + '"');
    return {number, at == std::string_view::npos ? 1 : static_cast<std::uint32_t>(at + 1)};
  }
  void error(SourceLocation place, std::string message) const {
    diagnostics.add({Severity::error, file, place, std::move(message)});
  }
};

struct PointerRow {
  std::string_view name;
  InputRow::Kind kind;
};
constexpr std::array<PointerRow, 5> kPointerRows = {{{"move", InputRow::Kind::move},
                                                     {"press", InputRow::Kind::press},
                                                     {"release", InputRow::Kind::release},
                                                     {"drag", InputRow::Kind::drag_sensor},
                                                     {"viewer", InputRow::Kind::visit}}};

std::optional<InputRow> read_key(const LineReader& in, const Json& row, double time) {
  InputRow result;
  result.kind = InputRow::Kind::key;
  result.time = time;
  result.location = in.place_of("key");
  const auto down = row.find("down");
  const auto key = row.at("key").is_string() ? find_key(row.at("key").get<std::string>()) : std::nullopt;
  if (!key) {
    in.error(result.location, "expected \"key\": the name of a key");
  } else if (down == row.end() || !down->is_boolean()) {
    in.error(result.location, "expected \"down\": true or false");
  } else {
    result.key = *key;
    result.down = down->get<bool>();
    return result;
  }
  return std::nullopt;
}

bool read_numbers(const Json& list, double farthest, std::span<double> numbers) {
  if (!list.is_array() || list.size() != numbers.size()) return false;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!list[i].is_number() || !(std::abs(list[i].get<double>()) <= farthest)) return false;
    numbers[i] = list[i].get<double>();
  }
  return true;
}

std::optional<InputRow> read_pointer(const LineReader& in, const Json& row, const PointerRow& kind, double time) {
  InputRow result;
  result.kind = kind.kind;
  result.time = time;
  result.location = in.place_of(kind.name);
  constexpr double kFarthest = 1e6, kFarthestPlace = 1e12;
  const Json& value = row.at(std::string(kind.name));
  double numbers[3] = {};
  std::string expected = "[X,Y] in pixels from the upper left corner";
  bool good = false;
  if (kind.kind == InputRow::Kind::visit) {
    expected = "[X,Y,Z] in world coordinates";
    good = read_numbers(value, kFarthestPlace, numbers);
    result.place = {numbers[0], numbers[1], numbers[2]};
  } else if (kind.kind == InputRow::Kind::press && value.is_string()) {
    result.kind = InputRow::Kind::press_sensor;
    result.name = value.get<std::string>();
    good = true;
  } else if (kind.kind == InputRow::Kind::release && value.is_boolean() && value.get<bool>()) {
    result.kind = InputRow::Kind::release_sensor;
    good = true;
  } else {
    if (kind.kind == InputRow::Kind::drag_sensor) expected = "[X,Y] in pixels to the right and down";
    if (kind.kind == InputRow::Kind::press) expected += ", or the name of a sensor";
    if (kind.kind == InputRow::Kind::release) expected += ", or true";
    good = read_numbers(value, kFarthest, {numbers, 2});
    result.pointer = {numbers[0], numbers[1]};
  }
  if (good) return result;
  in.error(result.location, "expected \"" + std::string(kind.name) + "\": " + expected);
  return std::nullopt;
}

std::optional<InputRow> read_row(const LineReader& in, double earliest) {
  Json row;
  try {
    row = Json::parse(in.line);
  } catch (const Json::parse_error& problem) {
    in.error({in.number, static_cast<std::uint32_t>(std::max<std::size_t>(1, problem.byte))}, "not JSON");
    return std::nullopt;
  } catch (const Json::exception&) {
    in.error({in.number, 1}, "a number is too large");
    return std::nullopt;
  }
  if (!row.is_object()) {
    in.error({in.number, 1}, "expected a JSON object");
    return std::nullopt;
  }
  InputRow result;
  const auto time = row.find("t");
  if (time == row.end() || !time->is_number() || !std::isfinite(time->get<double>()) || time->get<double>() < 0) {
    in.error(in.place_of("t"), "expected \"t\": seconds since the start of the world, 0 or more");
    return std::nullopt;
  }
  result.time = time->get<double>();
  if (result.time < earliest) {
    in.error(in.place_of("t"), "lines must be in the order of time");
    return std::nullopt;
  }
  static constexpr std::array<std::string_view, 8> kSubjects = {"set",     "viewpoint", "move", "press",
                                                                "release", "drag",      "key",  "viewer"};
  const auto subjects = std::count_if(kSubjects.begin(), kSubjects.end(),
                                      [&](std::string_view subject) { return row.contains(subject); });
  if (subjects != 1) {
    in.error(
        {in.number, 1},
        "expected one of \"set\", \"viewpoint\", \"move\", \"press\", \"release\", \"drag\", \"key\" and \"viewer\"");
    return std::nullopt;
  }
  if (row.contains("key")) return read_key(in, row, result.time);
  for (const PointerRow& kind : kPointerRows)
    if (row.contains(kind.name)) return read_pointer(in, row, kind, result.time);
  const auto set = row.find("set"), viewpoint = row.find("viewpoint");
  if (viewpoint != row.end()) {
    result.kind = InputRow::Kind::viewpoint;
    result.location = in.place_of("viewpoint");
    if (!viewpoint->is_string() && !viewpoint->is_number_unsigned()) {
      in.error(result.location, "expected \"viewpoint\": a name or a number");
      return std::nullopt;
    }
    result.name = viewpoint->is_string() ? viewpoint->get<std::string>() : viewpoint->dump();
    return result;
  }
  result.location = in.place_of("set");
  result.value_location = in.place_of("value");
  const std::string target = set->is_string() ? set->get<std::string>() : std::string();
  const std::size_t point = target.rfind('.');
  if (point == std::string::npos || point == 0 || point + 1 == target.size()) {
    in.error(result.location, "expected \"set\": \"NODE.eventIn\"");
    return std::nullopt;
  }
  result.name = target.substr(0, point);
  result.event = target.substr(point + 1);
  const auto value = row.find("value");
  if (value == row.end() || !(value->is_string() || value->is_number() || value->is_boolean())) {
    in.error(result.value_location, "expected \"value\": a field value as VRML97 text");
    return std::nullopt;
  }
  result.value = value->is_string()    ? value->get<std::string>()
                 : value->is_boolean() ? (value->get<bool>() ? "TRUE" : "FALSE")
                                       : value->dump();
  return result;
}

}  // namespace

std::vector<InputRow> read_input_rows(std::string_view text, const std::string& file, Diagnostics& diagnostics) {
  std::vector<InputRow> rows;
  double earliest = 0;
  for (std::uint32_t number = 1; !text.empty(); ++number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    auto row = read_row({line, number, file, diagnostics}, earliest);
    if (!row) continue;
    earliest = row->time;
    rows.push_back(std::move(*row));
  }
  return rows;
}

}  // namespace gs::app
