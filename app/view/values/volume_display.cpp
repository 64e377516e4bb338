#include "app/view/values/volume_display.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace gs::app {
namespace {

constexpr std::array<VolumeModeRow, 4> kModes{{
    {VolumeMode::vectors, "vectors", "Vectors", "Gradient vectors with the transfer function"},
    {VolumeMode::maximum, "maximum", "Maximum", "Maximum of the values along each ray (MIP)"},
    {VolumeMode::minimum, "minimum", "Minimum", "Minimum of the values along each ray"},
    {VolumeMode::average, "average", "Average", "Average of the values along each ray, like an X-ray picture"},
}};

}  // namespace

std::span<const VolumeModeRow> volume_modes() { return kModes; }

const VolumeModeRow* find_volume_mode(std::string_view name) {
  const auto* const found =
      std::find_if(kModes.begin(), kModes.end(), [&](const VolumeModeRow& row) { return row.name == name; });
  return found == kModes.end() ? nullptr : found;
}

std::optional<float> read_share(std::string_view text) {
  const bool percent = text.ends_with('%');
  if (percent) text.remove_suffix(1);
  double share = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), share);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  if (percent) share /= 100;
  const auto found = static_cast<float>(share);
  return found >= kLeastShare && found <= kMostShare ? std::optional(found) : std::nullopt;
}

}  // namespace gs::app
