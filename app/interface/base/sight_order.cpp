#include "app/interface/base/sight_order.h"

#include <fribidi/fribidi.h>

#include <algorithm>
#include <numeric>

namespace gs::app {
namespace {

constexpr std::size_t kLongestLine = 4096;  // max characters of a line that is reordered

bool is_written_from_the_right(char32_t c) {
  return (c >= 0x0590 && c <= 0x08FF) || (c >= 0xFB1D && c <= 0xFDFF) || (c >= 0xFE70 && c <= 0xFEFE);
}

}  // namespace

std::size_t SightOrder::caret(std::size_t index) const {
  if (places.empty()) return 0;
  const bool behind = index >= places.size();
  const std::size_t place = places[behind ? places.size() - 1 : index];
  return place + (from_right[place] != behind ? 1 : 0);
}

std::size_t SightOrder::index_at(std::size_t place, bool right_half) const {
  if (place >= characters.size()) return places.size();
  const auto found = std::find(places.begin(), places.end(), place);
  const auto index = static_cast<std::size_t>(found - places.begin());
  return std::min(index + (from_right[place] != right_half ? 1 : 0), places.size());
}

bool has_right_to_left(const std::u32string& text) {
  return std::any_of(text.begin(), text.end(), is_written_from_the_right);
}

SightOrder sight_order(const std::u32string& text) {
  SightOrder order;
  order.characters = text;
  order.places.resize(text.size());
  std::iota(order.places.begin(), order.places.end(), std::size_t{0});
  order.from_right.assign(text.size(), false);
  if (text.empty() || text.size() > kLongestLine || !has_right_to_left(text)) return order;
  static_assert(sizeof(FriBidiChar) == sizeof(char32_t));
  const std::vector<FriBidiChar> logical(text.begin(), text.end());
  std::vector<FriBidiChar> visual(text.size() + 1);
  std::vector<FriBidiStrIndex> places(text.size());
  std::vector<FriBidiLevel> levels(text.size());
  FriBidiParType direction = FRIBIDI_PAR_ON;
  if (fribidi_log2vis(logical.data(), static_cast<FriBidiStrIndex>(text.size()), &direction, visual.data(),
                      places.data(), nullptr, levels.data()) == 0)
    return order;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto place = static_cast<std::size_t>(places[i]);
    if (place >= text.size()) continue;
    order.places[i] = place;
    order.from_right[place] = levels[i] % 2 != 0;
    order.characters[i] = visual[i] == FRIBIDI_CHAR_FILL ? SightOrder::kNothing : static_cast<char32_t>(visual[i]);
  }
  return order;
}

}  // namespace gs::app
