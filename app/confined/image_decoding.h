#pragma once

#include "render/image/image.h"

#include <cstddef>
#include <span>
#include <string>
#include <variant>

namespace gs::app {

/// Makes decode_confined() use this program for its children. Call it at the start of main(). Without it, or with an
/// empty path, decode_confined() decodes in this process, as tests and children do.
void set_decoder_program(std::string program);

/// Decodes an image as render::decode_image() does, but in a confined child process. Children are reused, and replaced
/// after a failure. Any thread; images of several threads are decoded at the same time.
[[nodiscard]] std::variant<render::Image, render::ImageError> decode_confined(std::span<const std::byte> bytes,
                                                                              const render::ImageLimits& limits);

}  // namespace gs::app
