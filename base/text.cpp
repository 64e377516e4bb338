#include "base/text.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace gs {
namespace {

constexpr std::array<const char*, 5> kSizeUnits{"B", "kB", "MB", "GB", "TB"};

std::size_t unit_of(std::uint64_t bytes) {
  std::size_t unit = 0;
  for (auto value = static_cast<double>(bytes); value >= 999.5 && unit + 1 < kSizeUnits.size(); ++unit) value /= 1000;
  return unit;
}

// Formats `bytes` in a unit. Shows one decimal, or none if `of` is in bytes or has three digits in this unit.
std::string in_unit(std::uint64_t bytes, std::size_t unit, std::uint64_t of) {
  double scale = 1;
  for (std::size_t i = 0; i < unit; ++i) scale *= 1000;
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 || static_cast<double>(of) / scale >= 99.95 ? "%.0f" : "%.1f",
                static_cast<double>(bytes) / scale);
  return text;
}

}  // namespace

std::string shortened(std::string_view text, std::size_t length) {
  std::size_t end = std::min(text.size(), length);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  std::string result(text.substr(0, end));
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  if (end < text.size()) result += "...";
  return result;
}

std::string readable_size(std::uint64_t bytes) {
  const std::size_t unit = unit_of(bytes);
  return in_unit(bytes, unit, bytes) + " " + kSizeUnits[unit];
}

std::string readable_part(std::uint64_t bytes, std::uint64_t of) {
  const std::size_t unit = unit_of(of);
  const bool alike = bytes == 0 || unit_of(bytes) == unit;  // otherwise a much smaller amount would show as 0.0
  return (alike ? in_unit(bytes, unit, of) : readable_size(bytes)) + " of " + in_unit(of, unit, of) + " " +
         kSizeUnits[unit];
}

}  // namespace gs
