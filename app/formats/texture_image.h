#pragma once

#include "app/base/world_budget.h"
#include "render/image/image.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <variant>

namespace gs::app {

/// A decoded picture, with the part of the budget that it takes.
struct Texture {
  std::shared_ptr<const render::Image> image;
  std::string note;  // that it was made smaller, and by which limit; empty where it was not
};

/// What decoding the picture of a texture may cost, as much as is left of the budget for pixels. No pixels to be kept:
/// there is too little.
[[nodiscard]] render::ImageLimits texture_limits(const WorldBudget& budget);

/// Decodes the picture of a texture. Large ones are made smaller while they are decoded, the smaller the less is left
/// of the budget for pixels. Safe for untrusted bytes.
[[nodiscard]] std::variant<Texture, render::ImageError> decode_texture(std::span<const std::byte> bytes,
                                                                       const WorldBudget& budget);

}  // namespace gs::app
