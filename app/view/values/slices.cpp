#include "app/view/values/slices.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gs::app {

std::optional<SliceWish> read_slice_wish(std::string_view text) {
  SliceWish wish;
  if (text.size() < 3 || text[0] < 'x' || text[0] > 'z' || text[1] != '=') return std::nullopt;
  wish.axis = static_cast<std::size_t>(text[0] - 'x');
  text.remove_prefix(2);
  wish.percent = text.ends_with('%');
  if (wish.percent) text.remove_suffix(1);
  const auto read = std::from_chars(text.data(), text.data() + text.size(), wish.place);
  const bool whole = read.ec == std::errc() && read.ptr == text.data() + text.size() && std::isfinite(wish.place);
  if (!whole || wish.place < 0 || (wish.percent && wish.place > 100)) return std::nullopt;
  return wish;
}

void apply(const SliceWish& wish, const std::array<std::uint32_t, 3>& dimensions, VolumeSlices& slices) {
  const double last = std::max(1.0, static_cast<double>(dimensions[wish.axis]) - 1);
  const double place = wish.percent ? wish.place / 100 : wish.place / last;
  slices.shown[wish.axis] = true;
  slices.places[wish.axis] = static_cast<float>(std::clamp(place, 0.0, 1.0));
}

std::vector<WindowPreset> window_presets(std::pair<float, float> range, std::string_view unit) {
  // Usual windows of radiology, as level and width in Hounsfield units.
  static constexpr std::array<std::pair<const char*, std::array<float, 2>>, 4> kWindows{
      {{"Soft tissue", {40, 400}}, {"Bone", {400, 1800}}, {"Lung", {-600, 1500}}, {"Brain", {40, 80}}}};
  const auto [least, most] = range;
  const bool is_hounsfield = unit == "HU" || (least <= -500 && most >= 500);
  const bool is_above = !is_hounsfield && least >= -50 && most >= 1500 && most <= 8000;
  std::vector<WindowPreset> presets;
  if (!is_hounsfield && !is_above) return presets;
  const float water = is_above ? 1000.0f : 0.0f;
  for (const auto& [label, window] : kWindows)
    presets.push_back({label,
                       "Window of computed tomography",
                       {water + window[0] - window[1] / 2, water + window[0] + window[1] / 2}});
  return presets;
}

}  // namespace gs::app
