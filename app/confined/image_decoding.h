#pragma once

#include "render/image/image.h"

#include <cstddef>
#include <span>
#include <variant>

namespace gs::app {

/// Decodes an image as render::decode_image() does, but in a confined child process. Children are reused, and replaced
/// after a failure. Any thread; images of several threads are decoded at the same time.
[[nodiscard]] std::variant<render::Image, render::ImageError> decode_confined(std::span<const std::byte> bytes,
                                                                              const render::ImageLimits& limits);

}  // namespace gs::app
