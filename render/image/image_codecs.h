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

/// Result of a decoder of decode_image(). All decoders below are safe for untrusted bytes.
using DecodedImage = std::variant<Image, ImageError>;
[[nodiscard]] DecodedImage decode_png(std::span<const std::byte> bytes, const ImageLimits& limits);
[[nodiscard]] DecodedImage decode_jpeg(std::span<const std::byte> bytes, const ImageLimits& limits);
[[nodiscard]] DecodedImage decode_gif(std::span<const std::byte> bytes, const ImageLimits& limits);
/// Decodes BMP, binary PPM and PGM with stb_image.
[[nodiscard]] DecodedImage decode_stb(std::span<const std::byte> bytes, const ImageLimits& limits);
[[nodiscard]] DecodedImage decode_targa(std::span<const std::byte> bytes, const ImageLimits& limits);
/// Decodes an image, a volume or a cube.
[[nodiscard]] DecodedImage decode_dds(std::span<const std::byte> bytes, const ImageLimits& limits);
/// Decodes a volume of at most 4 components.
[[nodiscard]] DecodedImage decode_nrrd(std::span<const std::byte> bytes, const ImageLimits& limits);
/// Decodes SGI images (.rgb, .bw, .sgi): 8 or 16 bits, verbatim or run-length encoded. A truncated file gives the
/// received rows.
[[nodiscard]] DecodedImage decode_sgi(std::span<const std::byte> bytes, const ImageLimits& limits);
/// Decodes the first frame of a movie. Defined in render/media/movie.cpp.
[[nodiscard]] DecodedImage decode_movie(std::span<const std::byte> bytes, const ImageLimits& limits);
/// Reports whether the bytes begin like a movie in a supported container. Defined in render/media/movie.cpp.
[[nodiscard]] bool is_movie(std::span<const std::byte> bytes);
/// Reports whether the bytes may be a Targa file. Targa has no signature.
[[nodiscard]] bool is_targa(std::span<const std::byte> bytes);

/// Row of the table of image formats. The first bytes identify the format.
struct ImageFormat {
  std::string_view name;
  std::string_view magic;
  DecodedImage (*decode)(std::span<const std::byte> bytes, const ImageLimits& limits);
};
/// Returns the table of image formats.
[[nodiscard]] std::span<const ImageFormat> image_formats();

/// Returns an error if an image of this size must not be decoded. Returns nullopt otherwise.
[[nodiscard]] std::optional<ImageError> refuse_size(const char* format, std::uint64_t width, std::uint64_t height,
                                                    const ImageLimits& limits);

/// Returns the side, in file pixels, of the square that becomes one pixel. Returns 1 if all of `width` x `height` may
/// be kept.
[[nodiscard]] std::uint32_t reduction_of(std::uint64_t width, std::uint64_t height, const ImageLimits& limits);

/// Scales an image down while its rows are decoded: each pixel is the mean of a square. Squares at the right and lower
/// edge may be incomplete.
class RowReducer {
 public:
  /// Sets the size of `image` and allocates its pixels. `image` must outlive this object.
  RowReducer(Image& image, std::uint32_t width, std::uint32_t height, std::uint32_t components,
             std::uint32_t reduction);
  /// Adds the next row from the top: width * components bytes. Ignores rows after `height`.
  void take(const std::uint8_t* row);
  /// Writes the last row of squares, which may be incomplete.
  void finish();

 private:
  void flush();
  Image& image_;
  std::uint32_t width_, height_, rows_ = 0, kept_ = 0, gathered_ = 0;
  std::vector<std::uint32_t> sums_;
};

}  // namespace gs::render
