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

}  // namespace gs::app
