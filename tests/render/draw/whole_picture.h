#pragma once

#include "render/draw/picture.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <variant>

namespace gs::render {

/// Draws the whole image into memory.
[[nodiscard]] inline std::variant<Image, ContextError> draw_whole_picture(Renderer& renderer, const RenderList& list,
                                                                          const Camera& camera,
                                                                          const PictureOptions& options,
                                                                          FrameStatistics* statistics = nullptr) {
  Image all{static_cast<std::uint32_t>(std::max(options.draw.width, 0)),
            static_cast<std::uint32_t>(std::max(options.draw.height, 0)),
            options.transparent ? 4u : 3u,
            {}};
  auto problem = draw_picture(
      renderer, list, camera, options,
      [&](Image& band) {
        all.pixels.insert(all.pixels.end(), band.pixels.begin(), band.pixels.end());
        return true;
      },
      statistics);
  if (problem) return std::move(*problem);
  return all;
}

}  // namespace gs::render
