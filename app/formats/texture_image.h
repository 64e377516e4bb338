#pragma once

#include "base/budget.h"
#include "render/image/image.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <variant>

namespace gs::app {

/// Decoded texture image with its share of the budget.
struct Texture {
  std::shared_ptr<const render::Image> image;
  std::string note;  // message about a reduced size and the limit that caused it; else empty
};

/// Returns the limits for decoding a texture, from the remaining pixel budget. If the budget is exhausted, the number
/// of kept pixels is 0.
[[nodiscard]] render::ImageLimits texture_limits(const WorldBudget& budget);

/// Draws the memory of an image from the pixel budget. Describes a reduced size in `note`.
[[nodiscard]] std::variant<Texture, render::ImageError> hold_texture(render::Image image, const WorldBudget& budget);

/// Decodes a texture image. Scales a large image down while decoding, if the remaining pixel budget requires that. Safe
/// for untrusted bytes.
[[nodiscard]] std::variant<Texture, render::ImageError> decode_texture(std::span<const std::byte> bytes,
                                                                       const WorldBudget& budget);

}  // namespace gs::app
