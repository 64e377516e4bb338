// Decoders of formats that real worlds use although VRML97 does not require them: BMP, PPM, PGM, Targa.
#include "base/text.h"
#include "render/image/image_codecs.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

// stb_image is compiled here, with only these decoders and without file access.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#define STBI_ONLY_PNM
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#define STBI_MAX_DIMENSIONS (1 << 20)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wextra"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace gs::render {
namespace {

struct Freer {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

/// Returns the error of the last call. The decoder often fails without a reason.
ImageError failure() {
  const char* const reason = stbi_failure_reason();
  return {std::string("it cannot be decoded: ") + (reason ? reason : "its header or its pixels are damaged")};
}

/// Reports whether a PPM or PGM header has a number of more than nine digits. The decoder does not check its numbers.
bool has_endless_number(std::string_view file) {
  if (!file.starts_with("P5") && !file.starts_with("P6")) return false;
  constexpr int kNumbers = 3;  // width, height, largest value
  constexpr std::size_t kMostDigits = 9;
  constexpr std::string_view kDigits = "0123456789";
  std::size_t at = 2;
  for (int number = 0; number < kNumbers && at < file.size(); ++number) {
    while (at < file.size() && kDigits.find(file[at]) == std::string_view::npos)
      at = file[at] == '#' ? std::min(file.find_first_of("\r\n", at), file.size()) : at + 1;
    const std::size_t end = std::min(file.find_first_not_of(kDigits, at), file.size());
    if (end - at > kMostDigits) return true;
    at = end;
  }
  return false;
}

}  // namespace

DecodedImage decode_stb(std::span<const std::byte> bytes, const ImageLimits& limits) {
  constexpr const char* kName = "picture";
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) return ImageError{"it is too long"};
  if (has_endless_number(text_of(bytes)))
    return ImageError{"its header has a number of more than nine digits; expected width, height and largest value"};
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, components = 0;
  stbi__g_failure_reason = nullptr;  // clear the reason of an earlier failure on this thread
  if (!stbi_info_from_memory(data, size, &width, &height, &components)) return failure();
  if (width <= 0 || height <= 0)
    return ImageError{"it has no pixels; its size is " + std::to_string(width) + " x " + std::to_string(height)};
  if (components < 1 || components > 4) return failure();
  const auto columns = static_cast<std::uint32_t>(width), rows = static_cast<std::uint32_t>(height);
  if (auto refused = refuse_size(kName, columns, rows, limits)) return std::move(*refused);
  // The decoder holds the complete image, and for some formats a second copy while it reorders rows.
  const std::uint64_t all = std::uint64_t{columns} * rows * static_cast<unsigned>(components);
  if (all > limits.working_bytes / 2) return ImageError{"it is too large to be decoded"};
  const std::unique_ptr<stbi_uc, Freer> pixels(stbi_load_from_memory(data, size, &width, &height, &components, 0));
  if (!pixels) return failure();
  if (static_cast<std::uint32_t>(width) != columns || static_cast<std::uint32_t>(height) != rows ||
      std::uint64_t{columns} * rows * static_cast<unsigned>(components) > all)
    return ImageError{"its header and its pixels do not match"};
  Image image;
  const auto kept = static_cast<std::uint32_t>(components);
  RowReducer reducer(image, columns, rows, kept, reduction_of(columns, rows, limits));
  for (std::uint32_t row = 0; row < rows; ++row) {
    if (limits.stopped && limits.stopped()) return ImageError{"cancelled"};
    reducer.take(pixels.get() + std::size_t{row} * columns * kept);
  }
  reducer.finish();
  return image;
}

bool is_targa(std::span<const std::byte> bytes) {
  // Targa has no signature, so check that the header is plausible.
  if (bytes.size() < 18) return false;
  const auto at = [&](std::size_t i) { return static_cast<unsigned>(bytes[i]); };
  const unsigned map = at(1), kind = at(2), bits = at(16);
  const bool known = kind == 1 || kind == 2 || kind == 3 || kind == 9 || kind == 10 || kind == 11;
  return map <= 1 && known && (bits == 8 || bits == 15 || bits == 16 || bits == 24 || bits == 32) &&
         (at(12) | at(13) << 8) > 0 && (at(14) | at(15) << 8) > 0 && (at(17) & 0xC0) == 0;
}

DecodedImage decode_targa(std::span<const std::byte> bytes, const ImageLimits& limits) {
  if (!is_targa(bytes)) return ImageError{"not a Targa file"};
  return decode_stb(bytes, limits);
}

}  // namespace gs::render
