#pragma once

#include "render/image.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gs::render {

/// The decoders behind decode_image; each may be given any bytes and allocates at most `max_pixels` pixels.
using DecodedImage = std::variant<Image, ImageError>;
[[nodiscard]] DecodedImage decode_png(std::span<const std::byte> bytes, std::size_t max_pixels);
[[nodiscard]] DecodedImage decode_jpeg(std::span<const std::byte> bytes, std::size_t max_pixels);
[[nodiscard]] DecodedImage decode_gif(std::span<const std::byte> bytes, std::size_t max_pixels);

/// A kind of image, known by its first bytes.
struct ImageFormat {
  std::string_view name;
  std::string_view magic;
  DecodedImage (*decode)(std::span<const std::byte> bytes, std::size_t max_pixels);
};
/// The table of all.
[[nodiscard]] std::span<const ImageFormat> image_formats();

/// Why an image of this size is not decoded, or nothing when it may be.
[[nodiscard]] std::optional<ImageError> refuse_size(const char* format, std::uint64_t width, std::uint64_t height,
                                                    std::size_t max_pixels);

}  // namespace gs::render
