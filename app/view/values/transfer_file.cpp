#include "app/view/values/transfer_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>

namespace gs::app {
namespace {

using TransferJson = nlohmann::ordered_json;

constexpr std::size_t kMaxText = std::size_t{1} << 20;  // max bytes of a file; a point takes about 60
constexpr std::string_view kFormat = "ghostspace transfer function";

std::string line_and_column(std::string_view text, std::size_t byte) {
  std::size_t line = 1, column = 1;
  for (const char c : text.substr(0, std::min(byte, text.size()))) {
    column = c == '\n' ? 1 : column + 1;
    line += c == '\n' ? 1 : 0;
  }
  return std::to_string(line) + ':' + std::to_string(column);
}

std::optional<double> finite_number(const TransferJson& value) {
  if (!value.is_number()) return std::nullopt;
  const double number = value.get<double>();
  return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

std::optional<qnv::Rgb8> point_color(const TransferJson& value) {
  if (value.is_string()) {
    const std::string& text = value.get_ref<const std::string&>();
    unsigned rgb = 0;
    const char *first = text.data() + 1, *end = text.data() + text.size();
    if (text.size() != 7 || text[0] != '#' || std::from_chars(first, end, rgb, 16).ptr != end) return std::nullopt;
    return qnv::Rgb8{static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8 & 255),
                     static_cast<std::uint8_t>(rgb & 255)};
  }
  if (!value.is_array() || value.size() != 3) return std::nullopt;
  std::array<std::uint8_t, 3> bytes{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = finite_number(value[i]);
    if (!number || *number < 0 || *number > 255) return std::nullopt;
    bytes[i] = static_cast<std::uint8_t>(std::lround(*number));
  }
  return qnv::Rgb8{bytes[0], bytes[1], bytes[2]};
}

/// Parses a point. Returns a message if it is invalid.
std::optional<std::string> read_point(const TransferJson& row, TransferFile::Point& point) {
  if (!row.is_object()) return "expected an object with value, color and opacity";
  const auto value = row.contains("value") ? finite_number(row["value"]) : std::nullopt;
  if (!value) return "value: expected a number";
  const auto color = row.contains("color") ? point_color(row["color"]) : std::nullopt;
  if (!color) return "color: expected \"#rrggbb\" or three numbers from 0 to 255";
  const auto opacity = row.contains("opacity") ? finite_number(row["opacity"]) : std::nullopt;
  if (!opacity || *opacity < 0 || *opacity > 1) return "opacity: expected a number from 0 to 1";
  point = {*value, *color, static_cast<float>(*opacity)};
  return std::nullopt;
}

}  // namespace

std::variant<TransferFile, std::string> read_transfer_file(std::string_view text, const std::string& name) {
  const auto wrong = [&](const std::string& what, std::size_t byte = 0) {
    return name + ':' + line_and_column(text, byte) + ": error: " + what;
  };
  if (text.size() > kMaxText) return wrong("the file exceeds 1 MB; expected a transfer function");
  TransferJson root;
  try {
    root = TransferJson::parse(text);
  } catch (const TransferJson::parse_error& problem) {
    return wrong("not JSON; expected a transfer function", problem.byte > 0 ? problem.byte - 1 : 0);
  } catch (const TransferJson::exception&) {  // a number exceeds the range of double
    return wrong("a number is too large; expected finite numbers");
  }
  if (!root.is_object() || !root.contains("points") || !root["points"].is_array())
    return wrong("expected an object with an array `points`");
  if (root.contains("format") && root["format"] != kFormat)
    return wrong("format: expected \"" + std::string(kFormat) + "\"");
  const TransferJson& rows = root["points"];
  if (rows.empty() || rows.size() > kMaxTransferPoints)
    return wrong("points: expected 1 to " + std::to_string(kMaxTransferPoints) + " of them");
  TransferFile file;
  if (root.contains("range")) {
    const TransferJson& range = root["range"];
    const bool pair = range.is_array() && range.size() == 2 && finite_number(range[0]) && finite_number(range[1]);
    if (!pair) return wrong("range: expected the minimum and the maximum value");
    file.has_values = true;
  }
  if (root.contains("units") && root["units"].is_string()) file.units = root["units"].get<std::string>().substr(0, 64);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TransferFile::Point point;
    if (auto problem = read_point(rows[i], point)) return wrong("points[" + std::to_string(i) + "]: " + *problem);
    file.points.push_back(point);
  }
  return file;
}

Transfer transfer_over(const TransferFile& file, std::pair<float, float> value_range) {
  const double least = value_range.first, width = static_cast<double>(value_range.second) - least;
  std::vector<TransferFile::Point> points = file.points;
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  Transfer all;
  for (const TransferFile::Point& point : points) {
    const double place = !file.has_values ? point.value : width > 0 ? (point.value - least) / width : 0;
    all.push_back({static_cast<float>(place), point.color, point.opacity});
  }
  if (all.empty()) return sound_transfer({});
  // Returns the function at an end of the data range, interpolated. Clamping an outer point to the end would change the
  // function.
  const auto at = [&](float place) {
    std::size_t next = 0;
    while (next < all.size() && all[next].value < place) ++next;
    if (next == 0) return qnv::TransferPoint{place, all.front().color, all.front().opacity};
    if (next == all.size()) return qnv::TransferPoint{place, all.back().color, all.back().opacity};
    const qnv::TransferPoint &from = all[next - 1], &to = all[next];
    const float part = to.value > from.value ? (place - from.value) / (to.value - from.value) : 1;
    const auto mix = [&](std::uint8_t a, std::uint8_t b) {
      return static_cast<std::uint8_t>(std::lround(static_cast<float>(a) + part * (static_cast<float>(b) - a)));
    };
    return qnv::TransferPoint{
        place,
        {mix(from.color.r, to.color.r), mix(from.color.g, to.color.g), mix(from.color.b, to.color.b)},
        from.opacity + part * (to.opacity - from.opacity)};
  };
  Transfer inside;
  if (all.front().value < 0) inside.push_back(at(0));
  for (const qnv::TransferPoint& point : all)
    if (point.value >= 0 && point.value <= 1) inside.push_back(point);
  if (all.back().value > 1) inside.push_back(at(1));
  if (inside.empty()) inside.push_back(at(0.5f));
  return sound_transfer(std::move(inside));
}

std::string transfer_text(const Transfer& transfer, std::pair<float, float> value_range, const std::string& units) {
  const double least = value_range.first, width = static_cast<double>(value_range.second) - least;
  // Write the shortest decimal number that gives the same float.
  const auto rounded = [](double value) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, static_cast<float>(value)).ptr;
    double number = 0;
    std::from_chars(digits, end, number);
    return number;
  };
  TransferJson root;
  root["format"] = kFormat;
  root["version"] = 1;
  root["range"] = {rounded(least), rounded(value_range.second)};
  if (!units.empty()) root["units"] = units;
  root["points"] = TransferJson::array();
  for (const qnv::TransferPoint& point : transfer) {
    char color[8];
    std::snprintf(color, sizeof color, "#%02x%02x%02x", static_cast<unsigned>(point.color.r),
                  static_cast<unsigned>(point.color.g), static_cast<unsigned>(point.color.b));
    TransferJson row;
    row["value"] = rounded(least + width * static_cast<double>(point.value));
    row["color"] = color;
    row["opacity"] = rounded(static_cast<double>(point.opacity));
    root["points"].push_back(std::move(row));
  }
  return root.dump(2, ' ', false, TransferJson::error_handler_t::replace) + "\n";
}

}  // namespace gs::app
