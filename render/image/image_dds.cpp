// Decoder of DirectDraw Surface: images, volumes and cubes of X3D textures. Uncompressed pixels and DXT1, DXT3, DXT5.
// https://learn.microsoft.com/windows/win32/direct3ddds/dx-graphics-dds-pguide
#include "render/image/image_codecs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>

namespace gs::render {
namespace {

constexpr std::size_t kDdsHeader = 128;
constexpr std::uint32_t kDdsAlpha = 1, kFourCC = 4;               // DDS_PIXELFORMAT.dwFlags
constexpr std::uint32_t kDdsCube = 0x200, kDdsVolume = 0x200000;  // dwCaps2
constexpr std::uint32_t kDxt1 = 0x31545844, kDxt3 = 0x33545844, kDxt5 = 0x35545844;

std::uint32_t dds_word(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{static_cast<std::uint8_t>(bytes[at + i])} << (8 * i);
  return value;
}
std::uint32_t dds_half_word(std::span<const std::byte> bytes, std::size_t at) {
  return static_cast<std::uint8_t>(bytes[at]) | std::uint32_t{static_cast<std::uint8_t>(bytes[at + 1])} << 8;
}

struct DdsHeader {
  std::uint32_t width, height, depth = 1, mipmaps = 1, bits = 0, code = 0;
  std::array<std::uint32_t, 4> masks{};  // red, green, blue, alpha
  bool cube = false;

  [[nodiscard]] bool compressed() const { return code != 0; }
  [[nodiscard]] std::size_t block_bytes() const { return code == kDxt1 ? 8 : 16; }
  /// Returns the bytes of one slice of a mipmap level.
  [[nodiscard]] std::uint64_t slice_bytes(std::uint32_t level) const {
    const std::uint64_t w = std::max(width >> level, 1u), h = std::max(height >> level, 1u);
    return compressed() ? (w + 3) / 4 * ((h + 3) / 4) * block_bytes() : w * h * (bits / 8);
  }
  /// Returns the bytes of one image with all its mipmaps.
  [[nodiscard]] std::uint64_t image_bytes() const {
    std::uint64_t sum = 0;
    for (std::uint32_t level = 0; level < mipmaps; ++level) sum += slice_bytes(level) * std::max(depth >> level, 1u);
    return sum;
  }
};

using DdsPixel = std::array<std::uint8_t, 4>;

std::uint8_t part_of(std::uint32_t pixel, std::uint32_t mask) {
  if (mask == 0) return 255;
  const int shift = std::countr_zero(mask);
  const std::uint64_t most = mask >> shift;
  return static_cast<std::uint8_t>(((pixel & mask) >> shift) * std::uint64_t{255} / most);
}

DdsPixel color_565(std::uint32_t c) {
  const auto wide = [](std::uint32_t value, std::uint32_t most) {
    return static_cast<std::uint8_t>(value * 255 / most);
  };
  return {wide(c >> 11, 31), wide(c >> 5 & 63, 63), wide(c & 31, 31), 255};
}

/// Decodes a block of 4 x 4 pixels.
void decode_block(std::span<const std::byte> block, std::uint32_t code, std::array<DdsPixel, 16>& out) {
  const std::span<const std::byte> colors = code == kDxt1 ? block : block.subspan(8);
  const std::uint32_t first = dds_half_word(colors, 0), second = dds_half_word(colors, 2),
                      indices = dds_word(colors, 4);
  std::array<DdsPixel, 4> palette{color_565(first), color_565(second), {}, {}};
  const bool four = first > second || code != kDxt1;
  for (std::size_t c = 0; c < 3; ++c) {
    const int a = palette[0][c], b = palette[1][c];
    palette[2][c] = static_cast<std::uint8_t>(four ? (2 * a + b) / 3 : (a + b) / 2);
    palette[3][c] = static_cast<std::uint8_t>(four ? (a + 2 * b) / 3 : 0);
  }
  palette[2][3] = 255;
  palette[3][3] = four ? 255 : 0;
  for (std::size_t i = 0; i < 16; ++i) out[i] = palette[indices >> (2 * i) & 3];
  if (code == kDxt3)
    for (std::size_t i = 0; i < 16; ++i)
      out[i][3] = static_cast<std::uint8_t>((static_cast<unsigned>(block[i / 2]) >> (i % 2 * 4) & 15) * 17);
  if (code != kDxt5) return;
  const int a = static_cast<int>(block[0]), b = static_cast<int>(block[1]);
  const std::uint64_t choices = dds_half_word(block, 2) | std::uint64_t{dds_word(block, 4)} << 16;
  for (std::size_t i = 0; i < 16; ++i) {
    const int k = static_cast<int>(choices >> (3 * i) & 7);
    const int value = k == 0   ? a
                      : k == 1 ? b
                      : a > b  ? ((8 - k) * a + (k - 1) * b) / 7
                      : k == 6 ? 0
                      : k == 7 ? 255
                               : ((6 - k) * a + (k - 1) * b) / 5;
    out[i][3] = static_cast<std::uint8_t>(value);
  }
}

/// Writes one slice as RGBA, rows from the top.
void decode_slice(std::span<const std::byte> bytes, const DdsHeader& header, std::uint8_t* to) {
  if (!header.compressed()) {
    const std::size_t size = header.bits / 8;
    for (std::size_t i = 0; i < std::size_t{header.width} * header.height; ++i) {
      std::uint32_t pixel = 0;
      for (std::size_t k = 0; k < size; ++k)
        pixel |= std::uint32_t{static_cast<std::uint8_t>(bytes[i * size + k])} << (8 * k);
      for (std::size_t c = 0; c < 4; ++c) *to++ = part_of(pixel, header.masks[c]);
    }
    return;
  }
  std::array<DdsPixel, 16> block;
  const std::uint32_t columns = (header.width + 3) / 4, rows = (header.height + 3) / 4;
  for (std::uint32_t by = 0; by < rows; ++by)
    for (std::uint32_t bx = 0; bx < columns; ++bx) {
      decode_block(bytes.subspan((std::size_t{by} * columns + bx) * header.block_bytes(), header.block_bytes()),
                   header.code, block);
      for (std::uint32_t i = 0; i < 16; ++i) {
        const std::uint32_t x = 4 * bx + i % 4, y = 4 * by + i / 4;
        if (x < header.width && y < header.height)
          std::copy(block[i].begin(), block[i].end(), to + (std::size_t{y} * header.width + x) * 4);
      }
    }
}

std::variant<DdsHeader, ImageError> read_dds_header(std::span<const std::byte> bytes, const ImageLimits& limits) {
  if (bytes.size() < kDdsHeader) return ImageError{"DDS file is truncated; expected a header of 128 bytes"};
  DdsHeader header{dds_word(bytes, 16), dds_word(bytes, 12)};
  const std::uint32_t flags = dds_word(bytes, 80), caps = dds_word(bytes, 112);
  if (caps & kDdsVolume) header.depth = std::max(dds_word(bytes, 24), 1u);
  header.cube = (caps & kDdsCube) != 0;
  header.mipmaps = std::clamp(dds_word(bytes, 28), 1u, 32u);
  const std::uint64_t slices = header.cube ? 6 : header.depth;
  if (slices > 4096) return ImageError{"DDS volume of " + std::to_string(slices) + " slices; expected at most 4096"};
  if (auto refused = refuse_size("DDS", header.width, std::uint64_t{header.height} * slices, limits))
    return std::move(*refused);
  if (flags & kFourCC) {
    header.code = dds_word(bytes, 84);
    if (header.code != kDxt1 && header.code != kDxt3 && header.code != kDxt5)
      return ImageError{"DDS compression is not supported; expected DXT1, DXT3, DXT5 or none"};
    return header;
  }
  header.bits = dds_word(bytes, 88);
  if (header.bits != 8 && header.bits != 16 && header.bits != 24 && header.bits != 32)
    return ImageError{"DDS with " + std::to_string(header.bits) + " bits per pixel; expected 8, 16, 24 or 32"};
  for (std::size_t c = 0; c < 4; ++c) header.masks[c] = dds_word(bytes, 92 + 4 * c);
  if (!(flags & kDdsAlpha)) header.masks[3] = 0;
  if (header.masks[1] == 0 && header.masks[2] == 0) header.masks[1] = header.masks[2] = header.masks[0];  // luminance
  return header;
}

}  // namespace

DecodedImage decode_dds(std::span<const std::byte> bytes, const ImageLimits& limits) {
  auto read = read_dds_header(bytes, limits);
  if (auto* error = std::get_if<ImageError>(&read)) return std::move(*error);
  const DdsHeader& header = std::get<DdsHeader>(read);
  const std::uint32_t slices = header.cube ? 6 : header.depth;
  const std::uint64_t pixels = std::uint64_t{header.width} * header.height * slices;
  if (pixels > limits.kept_pixels || pixels * 4 > limits.working_bytes)
    return ImageError{"DDS image of " + std::to_string(pixels) + " pixels; expected at most " +
                      std::to_string(limits.kept_pixels)};
  Image image{header.width, header.height * slices, 4, {}};
  image.slices = slices;
  image.cube = header.cube;
  image.pixels.resize(pixels * 4);
  for (std::uint32_t slice = 0; slice < slices; ++slice) {
    if (limits.stopped && limits.stopped()) return ImageError{"cancelled"};
    const std::uint64_t offset =
        kDdsHeader + (header.cube ? header.image_bytes() * slice : header.slice_bytes(0) * slice);
    if (offset + header.slice_bytes(0) > bytes.size()) {
      if (slice == 0) return ImageError{"DDS file is truncated"};
      break;  // the rest stays transparent
    }
    decode_slice(bytes.subspan(offset, header.slice_bytes(0)), header,
                 image.pixels.data() + std::size_t{slice} * header.width * header.height * 4);
  }
  return image;
}

}  // namespace gs::render
