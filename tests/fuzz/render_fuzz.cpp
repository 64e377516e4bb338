// A target for every row of the table of images.
#include "render/image/image_codecs.h"
#include "tests/fuzz/fuzz_target.h"

#include <zlib.h>

using namespace gs::render;

namespace gs::fuzz {
namespace {

/// A PNG whose chunks have the checksums that a mutation broke (PNG, clause 5.3); anything else as it is.
std::vector<std::byte> mended(std::span<const std::byte> bytes) {
  std::vector<std::byte> png(bytes.begin(), bytes.end());
  constexpr std::size_t kMark = 8, kAround = 12;
  if (!text_of(bytes).starts_with("\x89PNG")) return png;
  for (std::size_t at = kMark; at + kAround <= png.size();) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i) size = size << 8 | std::to_integer<std::size_t>(png[at + i]);
    if (size > png.size() - at - kAround) break;
    const auto* checked = reinterpret_cast<const Bytef*>(png.data() + at + 4);
    const auto sum = static_cast<std::uint32_t>(crc32_z(0, checked, size + 4));
    for (std::size_t i = 0; i < 4; ++i) png[at + 8 + size + i] = static_cast<std::byte>(sum >> (24 - 8 * i));
    at += size + kAround;
  }
  return png;
}

bool run_image(const ImageFormat& format, std::span<const std::byte> input) {
  const std::vector<std::byte> bytes = mended(input);
  constexpr std::size_t kMostPixels = std::size_t{1} << 22;
  const DecodedImage decoded = format.decode(bytes, {.file_pixels = kMostPixels});
  const auto* image = std::get_if<Image>(&decoded);
  if (!image) {
    require(!std::get<ImageError>(decoded).message.empty());
    return false;
  }
  require(image->components >= 1 && image->components <= 4);
  require(std::uint64_t{image->width} * image->height <= kMostPixels);
  require(image->pixels.size() == std::size_t{image->width} * image->height * image->components);
  if (text_of(bytes).starts_with(format.magic)) require(decode_image(bytes, {.file_pixels = kMostPixels}).index() == 0);
  return text_of(bytes).starts_with(format.magic);
}

}  // namespace

std::vector<FuzzTarget> fuzz_targets() {
  std::vector<FuzzTarget> targets;
  for (const ImageFormat& format : image_formats())
    targets.push_back(
        {target_name(format.name), [&format](std::span<const std::byte> bytes) { return run_image(format, bytes); }});
  return targets;
}

}  // namespace gs::fuzz
