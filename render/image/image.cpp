#include "render/image/image.h"

#include "render/image/image_codecs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string_view>

namespace gs::render {
namespace {

using namespace std::string_view_literals;
constexpr std::array<ImageFormat, 17> kImageFormats = {{
    {"PNG"sv, "\x89PNG\r\n\x1a\n"sv, decode_png},
    {"JPEG"sv, "\xff\xd8\xff"sv, decode_jpeg},
    {"GIF87a"sv, "GIF87a"sv, decode_gif},
    {"GIF89a"sv, "GIF89a"sv, decode_gif},
    {"BMP"sv, "BM"sv, decode_stb},
    {"PPM"sv, "P6"sv, decode_stb},
    {"PGM"sv, "P5"sv, decode_stb},
    {"DDS"sv, "DDS "sv, decode_dds},
    {"NRRD"sv, "NRRD"sv, decode_nrrd},
    {"SGI"sv, "\x01\xda"sv, decode_sgi},
    {"MPEG system stream"sv, "\x00\x00\x01\xba"sv, decode_movie},
    {"MPEG video"sv, "\x00\x00\x01\xb3"sv, decode_movie},
    {"AVI"sv, "RIFF"sv, decode_movie},
    {"Matroska"sv, "\x1a\x45\xdf\xa3"sv, decode_movie},
    {"Ogg"sv, "OggS"sv, decode_movie},
    {"ISO media"sv, ""sv, decode_movie},  // signature at offset 4, after a length
    {"Targa"sv, ""sv, decode_targa},      // last, because Targa has no signature
}};

std::string hexadecimal(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::byte b : bytes) {
    if (!text.empty()) text += ' ';
    text += kDigits[static_cast<unsigned>(b) >> 4];
    text += kDigits[static_cast<unsigned>(b) & 15u];
  }
  return text;
}

}  // namespace

std::span<const ImageFormat> image_formats() { return kImageFormats; }

std::optional<ImageError> refuse_size(const char* format, std::uint64_t width, std::uint64_t height,
                                      const ImageLimits& limits) {
  // Maximum side of an image in pixels. Limits libpng's row buffers.
  constexpr std::uint64_t kMaxSide = 1'000'000;
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  if (width == 0 || height == 0)
    return ImageError{std::string(format) + " image of " + size + " pixels; expected at least one pixel"};
  if (width > kMaxSide || height > kMaxSide || width * height > limits.file_pixels)
    return ImageError{std::string(format) + " image of " + size + " pixels; expected at most " +
                      std::to_string(limits.file_pixels) + " pixels and no side over " + std::to_string(kMaxSide)};
  return std::nullopt;
}

std::uint32_t reduction_of(std::uint64_t width, std::uint64_t height, const ImageLimits& limits) {
  std::uint32_t reduction = 1;
  const auto kept = [&](std::uint64_t side) { return (side + reduction - 1) / reduction; };
  while (kept(width) * kept(height) > std::max<std::size_t>(limits.kept_pixels, 1)) ++reduction;
  return reduction;
}

RowReducer::RowReducer(Image& image, std::uint32_t width, std::uint32_t height, std::uint32_t components,
                       std::uint32_t reduction)
    : image_(image), width_(width), height_(height) {
  image.width = (width - 1) / reduction + 1;
  image.height = (height - 1) / reduction + 1;
  image.components = components;
  image.reduction = reduction;
  image.pixels.resize(std::size_t{image.width} * image.height * components);
  sums_.resize(std::size_t{image.width} * components);
}

void RowReducer::take(const std::uint8_t* row) {
  if (rows_ >= height_) return;
  ++rows_;
  const std::size_t components = image_.components;
  std::uint32_t* sum = sums_.data();
  for (std::uint32_t x = 0; x < width_; sum += components)
    for (const std::uint32_t end = std::min(width_, x + image_.reduction); x < end; ++x)
      for (std::size_t c = 0; c < components; ++c) sum[c] += *row++;
  if (++gathered_ == image_.reduction) flush();
}

void RowReducer::finish() {
  if (gathered_ > 0) flush();
}

void RowReducer::flush() {
  std::uint8_t* to = image_.pixels.data() + std::size_t{kept_} * sums_.size();
  const std::size_t components = image_.components;
  for (std::uint32_t x = 0; x < image_.width; ++x) {
    const std::uint32_t across = std::min(image_.reduction, width_ - x * image_.reduction);
    for (std::size_t c = 0; c < components; ++c)
      *to++ = static_cast<std::uint8_t>(sums_[x * components + c] / (across * gathered_));
  }
  std::fill(sums_.begin(), sums_.end(), 0u);
  gathered_ = 0;
  ++kept_;
}

std::variant<Image, ImageError> decode_image(std::span<const std::byte> bytes, const ImageLimits& limits) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const ImageFormat& format : kImageFormats)
    if (!format.magic.empty() && text.starts_with(format.magic)) return format.decode(bytes, limits);
  if (is_movie(bytes)) return decode_movie(bytes, limits);
  if (is_targa(bytes)) return decode_targa(bytes, limits);
  const std::string start =
      bytes.empty() ? "nothing" : hexadecimal(bytes.first(std::min<std::size_t>(bytes.size(), 8)));
  return ImageError{
      "unsupported image format; expected the first bytes of a PNG, JPEG, GIF, BMP, PPM, SGI, Targa, DDS, NRRD or "
      "movie, found " +
      start};
}

}  // namespace gs::render
