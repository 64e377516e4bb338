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
  std::string note;  // message about a size reduction and the limit behind it; else empty
};

/// Returns the limits for decoding a texture from the remaining pixel budget. 0 kept pixels mean that the budget is
/// spent.
[[nodiscard]] render::ImageLimits texture_limits(const WorldBudget& budget);

/// Decodes a texture image. Scales large images down while decoding, depending on the remaining pixel budget. Safe for
/// untrusted bytes.
[[nodiscard]] std::variant<Texture, render::ImageError> decode_texture(std::span<const std::byte> bytes,
                                                                       const WorldBudget& budget);

}  // namespace gs::app
