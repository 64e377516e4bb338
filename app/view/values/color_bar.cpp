#include "app/view/values/color_bar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string_view>

namespace gs::app {
namespace {

std::string printed(const char* format, int digits, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, digits, value);
  return buffer;
}

std::string tick_label(double value, double step) {
  const int exponent = static_cast<int>(std::floor(std::log10(step) + 1e-9));
  const double largest = std::abs(value);
  if (exponent < -5 || largest >= 1e7) {
    const int digits = largest > 0 ? static_cast<int>(std::floor(std::log10(largest))) - exponent : 0;
    return printed("%.*e", std::clamp(digits, 0, 16), value);
  }
  return printed("%.*f", std::max(0, -exponent), value);
}

std::string find_metadata(const qnv::Description& volume, std::span<const std::string_view> keys) {
  for (const std::string_view key : keys)
    for (const auto& [name, text] : volume.metadata)
      if (name == key && !text.empty()) return text;
  return {};
}

}  // namespace

std::vector<Tick> nice_ticks(std::pair<double, double> range, std::size_t most) {
  const double least = range.first, largest = range.second;
  const double width = largest - least;
  const auto ends = [&] {
    std::vector<Tick> ticks{{least, 0, readable_value(least)}};
    if (width > 0 && most > 1) ticks.push_back({largest, 1, readable_value(largest)});
    return ticks;
  };
  if (!(width > 0) || !std::isfinite(width) || most < 2) return ends();
  static constexpr std::array<double, 3> kSteps{1, 2, 5};
  for (double power = std::pow(10, std::floor(std::log10(width / static_cast<double>(most)))); std::isfinite(power);
       power *= 10) {
    for (const double multiple : kSteps) {
      const double step = power * multiple;
      if (!(step > 0)) return ends();
      const double slack = 1e-9 * width;  // tolerance for rounding
      const double first = std::ceil((least - slack) / step), last = std::floor((largest + slack) / step);
      if (last - first + 1 > static_cast<double>(most)) continue;
      if (last < first) return ends();
      std::vector<Tick> ticks;
      for (double i = first; i <= last; ++i) {
        const double value = i == 0 ? 0 : i * step;  // prevents -0
        ticks.push_back({value, std::clamp((value - least) / width, 0.0, 1.0), tick_label(value, step)});
      }
      return ticks;
    }
  }
  return ends();
}

ColorBar color_bar_of(const qnv::Description& volume, const Transfer& transfer) {
  const std::string name = value_name(volume), unit = value_unit(volume);
  ColorBar bar;
  bar.title = name.empty() ? unit : unit.empty() ? name : name + " (" + unit + ")";
  bar.range = {static_cast<double>(volume.value_range.first), static_cast<double>(volume.value_range.second)};
  bar.colors = transfer;
  return bar;
}

ColorBar color_bar_of(const ColorKey& key) {
  ColorBar bar{key.title, {key.low, key.high}, {}};
  for (std::size_t i = 0; i < key.colors.size(); ++i) {
    const auto byte = [](float part) {
      return static_cast<std::uint8_t>(std::lround(std::clamp(part, 0.0f, 1.0f) * 255));
    };
    const vrml::Color& color = key.colors[i];
    const float place = static_cast<float>(i) / static_cast<float>(std::max<std::size_t>(key.colors.size(), 2) - 1);
    bar.colors.push_back({place, {byte(color.r), byte(color.g), byte(color.b)}, 1});
  }
  return bar;
}

std::string value_unit(const qnv::Description& volume) {
  static constexpr std::array<std::string_view, 4> kKeys{"units", "sample units", "value units", "unit"};
  return find_metadata(volume, kKeys);
}

std::string value_name(const qnv::Description& volume) {
  static constexpr std::array<std::string_view, 2> kKeys{"array", "label"};
  std::string name = find_metadata(volume, kKeys);
  constexpr std::size_t kMax = 40;  // max bytes of a unit or name
  if (name.size() > kMax) {
    std::size_t end = kMax;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;
    name = name.substr(0, end) + "...";
  }
  return name;
}

std::string readable_value(double value, const std::string& unit, int digits) {
  std::string text = printed("%.*g", digits, value);
  return unit.empty() ? text : text + ' ' + unit;
}

}  // namespace gs::app
