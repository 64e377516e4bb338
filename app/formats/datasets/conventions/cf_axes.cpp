#include "app/formats/datasets/conventions/cf_axes.h"

#include "app/formats/common/text_cursor.h"
#include "app/formats/datasets/conventions/convention.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace gs::app {
namespace {

bool contains_any(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::ranges::any_of(words,
                             [text](std::string_view word) { return text.find(word) != std::string_view::npos; });
}

bool is_pressure(std::string_view unit) {
  static constexpr std::string_view kUnits[] = {"pa",       "hpa",       "kpa", "mb",   "mbar",
                                                "millibar", "millibars", "bar", "dbar", "decibar"};
  return std::ranges::find(kUnits, unit) != std::end(kUnits);
}

std::optional<AxisRole> role_by_attributes(DatasetTree& tree, const std::string& path) {
  const std::string axis = lower_case(tree.text(path, "axis"));
  static constexpr std::pair<std::string_view, AxisRole> kAxes[] = {
      {"x", AxisRole::x}, {"y", AxisRole::y}, {"z", AxisRole::z}, {"t", AxisRole::time}};
  if (const auto role = value_named(kAxes, axis)) return role;
  const std::string unit = lower_case(tree.text(path, "units")),
                    standard = lower_case(tree.text(path, "standard_name"));
  if (contains_any(unit, {" since "}) || standard == "time") return AxisRole::time;
  if (contains_any(unit, {"degrees_east", "degree_east", "degrees_e", "degree_e"}) ||
      contains_any(standard, {"longitude", "projection_x"}))
    return AxisRole::x;
  if (contains_any(unit, {"degrees_north", "degree_north", "degrees_n", "degree_n"}) ||
      contains_any(standard, {"latitude", "projection_y"}))
    return AxisRole::y;
  if (is_pressure(unit) || !tree.text(path, "positive").empty() ||
      contains_any(standard, {"height", "depth", "altitude", "pressure", "model_level", "sigma"}))
    return AxisRole::z;
  return std::nullopt;
}

std::optional<AxisRole> role_by_name(std::string_view path) {
  static constexpr std::pair<std::string_view, AxisRole> kNames[] = {
      {"x", AxisRole::x},        {"lon", AxisRole::x},      {"longitude", AxisRole::x}, {"y", AxisRole::y},
      {"lat", AxisRole::y},      {"latitude", AxisRole::y}, {"z", AxisRole::z},         {"lev", AxisRole::z},
      {"level", AxisRole::z},    {"levels", AxisRole::z},   {"plev", AxisRole::z},      {"depth", AxisRole::z},
      {"height", AxisRole::z},   {"altitude", AxisRole::z}, {"t", AxisRole::time},      {"time", AxisRole::time},
      {"month", AxisRole::time}, {"year", AxisRole::time},  {"day", AxisRole::time},    {"nlon", AxisRole::x},
      {"nlat", AxisRole::y},     {"nx", AxisRole::x},       {"ny", AxisRole::y},        {"nz", AxisRole::z},
      {"xc", AxisRole::x},       {"yc", AxisRole::y}};
  return value_named(kNames, lower_case(name_of_path(path)));
}

bool is_never_space(std::string_view name) {
  return contains_any(lower_case(name),
                      {"member", "ensemble", "realization", "band", "bnds", "bounds", "channel", "nv"});
}

/// Makes longitudes ascend that jump from 180 to -180 or from 360 to 0.
void unwrap(std::vector<double>& degrees) {
  constexpr double kJump = 180, kTurn = 360;
  double turn = 0;
  for (std::size_t i = 1; i < degrees.size(); ++i) {
    const double next = degrees[i] + turn;
    if (degrees[i - 1] - next > kJump) turn += kTurn;
    degrees[i] += turn;
  }
}

/// Calendar of climate models.
struct Calendar {
  enum class Kind : std::uint8_t { gregorian, julian, no_leap, all_leap, days_360 } kind = Kind::gregorian;

  static Calendar named(std::string_view name) {
    static constexpr std::pair<std::string_view, Kind> kNames[] = {
        {"julian", Kind::julian},     {"noleap", Kind::no_leap},   {"365_day", Kind::no_leap},
        {"all_leap", Kind::all_leap}, {"366_day", Kind::all_leap}, {"360_day", Kind::days_360}};
    return {value_named(kNames, name).value_or(Kind::gregorian)};
  }
  [[nodiscard]] bool is_leap(std::int64_t year) const {
    switch (kind) {
      case Kind::gregorian:
        return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
      case Kind::julian:
        return year % 4 == 0;
      default:
        return kind == Kind::all_leap;
    }
  }
  [[nodiscard]] int days_of_month(std::int64_t year, int month) const {
    constexpr int kDays[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    if (kind == Kind::days_360) return 30;
    return month == 2 && is_leap(year) ? 29 : kDays[month - 1];
  }
  [[nodiscard]] int days_of_year(std::int64_t year) const {
    return kind == Kind::days_360 ? 360 : is_leap(year) ? 366 : 365;
  }
};

}  // namespace

bool is_degrees(std::string_view unit) { return lower_case(unit).starts_with("degree"); }

std::optional<AxisRole> cf_role(DatasetTree& tree, const std::string& path, std::string_view name) {
  if (const auto role = tree.find(path) ? role_by_attributes(tree, path) : std::nullopt) return role;
  return role_by_name(name);
}

std::vector<CfAxis> cf_axes(DatasetTree& tree, const ArrayInfo& array) {
  std::vector<CfAxis> axes(array.shape.size());
  std::array<bool, static_cast<std::size_t>(AxisRole::channel) + 1> used{};
  for (std::size_t i = axes.size(); i-- > 0;) {
    CfAxis& axis = axes[i];
    if (i >= array.dimensions.size() || array.dimensions[i].empty()) continue;
    axis.name = name_of_path(array.dimensions[i]);
    const ArrayInfo* const found = tree.find(array.dimensions[i]);
    const bool has_values = found && found->shape.size() == 1 && found->shape[0] == array.shape[i] &&
                            !tree.text(found->path, "NAME").starts_with("This is a netCDF dimension but not");
    if (has_values) {
      axis.path = found->path;
      axis.unit = tree.text(found->path, "units");
      axis.standard_name = tree.text(found->path, "standard_name");
    }
    auto role = cf_role(tree, axis.path, axis.name);
    if (role && std::exchange(used[static_cast<std::size_t>(*role)], true)) role.reset();
    axis.role = role;
    if (has_values) axis.values = tree.coordinate(axis.path);
    const std::string positive = lower_case(tree.text(axis.path, "positive"));
    axis.down = positive == "down" || (positive.empty() && (is_pressure(lower_case(axis.unit)) ||
                                                            lower_case(axis.name).find("depth") != std::string::npos));
    if (role == AxisRole::x && is_degrees(axis.unit)) unwrap(axis.values);
  }
  constexpr AxisRole kSpace[] = {AxisRole::x, AxisRole::y, AxisRole::z};
  for (std::size_t i = axes.size(); i-- > 0;) {
    if (axes[i].role || array.shape[i] < 2 || is_never_space(axes[i].name)) continue;
    for (const AxisRole role : kSpace)
      if (!axes[i].role && !std::exchange(used[static_cast<std::size_t>(role)], true)) axes[i].role = role;
  }
  for (CfAxis& axis : axes)
    if (!axis.role) axis.role = AxisRole::channel;
  return axes;
}

std::string cf_date(double number, const std::string& units, const std::string& calendar) {
  static constexpr std::pair<std::string_view, double> kSeconds[] = {
      {"s", 1},        {"sec", 1},      {"second", 1}, {"seconds", 1}, {"min", 60},     {"minute", 60},
      {"minutes", 60}, {"h", 3600},     {"hr", 3600},  {"hour", 3600}, {"hours", 3600}, {"d", 86400},
      {"day", 86400},  {"days", 86400}, {"hrs", 3600}, {"secs", 1}};
  const std::size_t since = units.find(" since ");
  if (since == std::string::npos || !std::isfinite(number)) return {};
  const auto seconds = value_named(kSeconds, lower_case(units.substr(0, since)));
  std::array<int, 6> date{1970, 1, 1, 0, 0, 0};
  if (!seconds || std::sscanf(units.c_str() + since + 7, "%d-%d-%d%*[ T]%d:%d:%d", &date[0], &date[1], &date[2],
                              &date[3], &date[4], &date[5]) < 3)
    return {};
  const Calendar days = Calendar::named(lower_case(calendar));
  constexpr double kDay = 86400, kMostDays = 4e6;
  if (date[1] < 1 || date[1] > 12 || date[0] < 0 || date[0] > 9999) return {};
  double all = date[2] - 1;
  for (int month = 1; month < date[1]; ++month) all += days.days_of_month(date[0], month);
  all += (date[3] * 3600.0 + date[4] * 60.0 + date[5] + number * *seconds) / kDay;
  if (!(std::abs(all) < kMostDays)) return {};
  std::int64_t year = date[0];
  while (all < 0) all += days.days_of_year(--year);
  while (all >= days.days_of_year(year)) all -= days.days_of_year(year++);
  int month = 1;
  while (all >= days.days_of_month(year, month)) all -= days.days_of_month(year, month++);
  const auto day = static_cast<int>(all);
  const auto minutes = static_cast<int>((all - day) * 24 * 60 + 0.5);
  char text[64];
  std::snprintf(text, sizeof text, "%04lld-%02d-%02d %02d:%02d", static_cast<long long>(year), month, day + 1,
                minutes / 60, minutes % 60);
  return text;
}

std::vector<std::string> cf_paths(DatasetTree& tree, const std::string& path, std::string_view attribute) {
  std::vector<std::string> paths;
  const std::string text = tree.text(path, attribute), folder = folder_of_path(path);
  TextCursor cursor(text.data(), text.data() + text.size());
  constexpr std::size_t kMostNames = 64;
  while (paths.size() < kMostNames) {
    const std::string_view name = cursor.word();
    if (name.empty()) break;
    std::string full = (folder == "/" ? "/" : folder + "/") + std::string(name);
    if (!tree.find(full) && tree.find("/" + std::string(name))) full = "/" + std::string(name);
    paths.push_back(std::move(full));
  }
  return paths;
}

}  // namespace gs::app
