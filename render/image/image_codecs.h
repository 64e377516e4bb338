#pragma once

#include "render/image/image.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::render {

/// The decoders behind decode_image; each may be given any bytes.
using DecodedImage = std::variant<Image, ImageError>;
[[nodiscard]] DecodedImage decode_png(std::span<const std::byte> bytes, const ImageLimits& limits);
[[nodiscard]] DecodedImage decode_jpeg(std::span<const std::byte> bytes, const ImageLimits& limits);
[[nodiscard]] DecodedImage decode_gif(std::span<const std::byte> bytes, const ImageLimits& limits);
/// BMP and binary PPM and PGM.
[[nodiscard]] DecodedImage decode_stb(std::span<const std::byte> bytes, const ImageLimits& limits);
[[nodiscard]] DecodedImage decode_targa(std::span<const std::byte> bytes, const ImageLimits& limits);
/// The first picture of a movie (movie.h).
[[nodiscard]] DecodedImage decode_movie(std::span<const std::byte> bytes, const ImageLimits& limits);
/// Whether the bytes may be a Targa file, which nothing marks as one.
[[nodiscard]] bool is_targa(std::span<const std::byte> bytes);

/// A kind of image, known by its first bytes.
struct ImageFormat {
  std::string_view name;
  std::string_view magic;
  DecodedImage (*decode)(std::span<const std::byte> bytes, const ImageLimits& limits);
};
/// The table of all.
[[nodiscard]] std::span<const ImageFormat> image_formats();

/// Why an image of this size is not decoded, or nothing when it may be.
[[nodiscard]] std::optional<ImageError> refuse_size(const char* format, std::uint64_t width, std::uint64_t height,
                                                    const ImageLimits& limits);

/// Pixels that one kept pixel stands for, in each direction: 1 where all of `width` x `height` may be kept.
[[nodiscard]] std::uint32_t reduction_of(std::uint64_t width, std::uint64_t height, const ImageLimits& limits);

/// Makes a smaller picture of rows as they come, by means of squares of pixels; of the last ones of parts.
class RowReducer {
 public:
  /// Gives `image` its size and makes its pixels. `image` and what is given to `take` outlive this.
  RowReducer(Image& image, std::uint32_t width, std::uint32_t height, std::uint32_t components,
             std::uint32_t reduction);
  /// The next row of the file, from the top: width * components bytes. More rows than `height` are ignored.
  void take(const std::uint8_t* row);
  /// The last square may be cut.
  void finish();

 private:
  void flush();
  Image& image_;
  std::uint32_t width_, height_, rows_ = 0, kept_ = 0, gathered_ = 0;
  std::vector<std::uint32_t> sums_;
};

}  // namespace gs::render
