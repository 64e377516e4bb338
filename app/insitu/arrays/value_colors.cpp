#include "app/insitu/arrays/value_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace gs::app::insitu {
namespace {

// Five samples of the colour map Viridis (matplotlib).
constexpr std::array<qnv::Rgb8, 5> kInsituViridis{
    {{0x44, 0x01, 0x54}, {0x3b, 0x52, 0x8b}, {0x21, 0x91, 0x8c}, {0x5e, 0xc9, 0x62}, {0xfd, 0xe7, 0x25}}};

std::uint8_t mixed_part(std::uint8_t a, std::uint8_t b, double part) {
  return static_cast<std::uint8_t>(std::lround(a + (static_cast<double>(b) - a) * part));
}

}  // namespace

void ValueColors::include(double value) {
  if (!std::isfinite(value)) return;
  low = any_ ? std::min(low, value) : value;
  high = any_ ? std::max(high, value) : value;
  any_ = true;
}

qnv::Rgb8 ValueColors::color_of(double value) const {
  if (!any_ || !std::isfinite(value)) return {128, 128, 128};
  constexpr double kLast = kInsituViridis.size() - 1;
  const double place = high > low ? std::clamp((value - low) / (high - low), 0.0, 1.0) * kLast : kLast / 2;
  const auto at = std::min(static_cast<std::size_t>(place), kInsituViridis.size() - 2);
  const qnv::Rgb8 &a = kInsituViridis[at], &b = kInsituViridis[at + 1];
  const double part = place - static_cast<double>(at);
  return {mixed_part(a.r, b.r, part), mixed_part(a.g, b.g, part), mixed_part(a.b, b.b, part)};
}

std::pair<std::string, std::string> ValueColors::metadata() const {
  std::string text = number_text(low) + ' ' + number_text(high);
  for (const qnv::Rgb8& color : kInsituViridis) {
    char one[16];
    std::snprintf(one, sizeof one, " #%02x%02x%02x", color.r, color.g, color.b);
    text += one;
  }
  if (!title.empty()) text += ' ' + title;
  return {"color key", std::move(text)};
}

std::string number_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", number);
  return text;
}

}  // namespace gs::app::insitu
