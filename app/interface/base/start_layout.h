#pragma once

#include "app/view/viewports.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gs::app {

/// Places of the thumbnails of a start page, in pixels of the framebuffer. Below each is one line of text.
struct StartLayout {
  static constexpr std::size_t kMax = 6;  // max thumbnails
  std::vector<Viewport> thumbnails;
  int top = 0;  // upper edge of the first row; `place.top` + half of the height if there are no thumbnails
};

/// Returns the layout for `count` recent files in the viewport `place`. `scale` is the number of pixels per unit of the
/// design. Omits thumbnails that do not fit.
[[nodiscard]] inline StartLayout start_layout(const Viewport& place, std::size_t count, float scale) {
  const auto units = [scale](float length) { return static_cast<int>(length * scale); };
  const int width = units(160), height = units(100), gap = units(20), line = units(26), head = units(90);
  StartLayout layout;
  layout.top = place.top + place.height / 2;
  const int columns = std::clamp((place.width - gap) / (width + gap), 0, 3);
  const int rows = std::clamp((place.height - head) / (height + line + gap), 0, 2);
  count = std::min({count, StartLayout::kMax, static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)});
  if (count == 0) return layout;
  const int used = std::min<int>(columns, static_cast<int>(count));
  const int lines = (static_cast<int>(count) + used - 1) / used;
  layout.top = place.top + head + (place.height - head - lines * (height + line + gap)) / 2;
  const int left = place.left + (place.width - used * (width + gap) + gap) / 2;
  for (int i = 0; i < static_cast<int>(count); ++i)
    layout.thumbnails.push_back(
        {left + i % used * (width + gap), layout.top + i / used * (height + line + gap), width, height});
  return layout;
}

}  // namespace gs::app
