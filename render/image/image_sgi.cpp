#include "render/image/image_codecs.h"

#include <algorithm>
#include <string>
#include <vector>

// Decoder of SGI images (.rgb, .rgba, .bw, .sgi), the textures of Inventor and VRML 1.0 files.
namespace gs::render {
namespace {

constexpr std::size_t kHeader = 512;

/// Header of a file. Its numbers are big-endian.
struct SgiFile {
  std::span<const std::byte> bytes;
  bool compressed = false;
  std::size_t sample_bytes = 1;  // bytes of one component of a pixel
  std::uint32_t width = 0, height = 0, channels = 0;

  [[nodiscard]] std::uint32_t number(std::size_t at, std::size_t size) const {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
      value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
    return value;
  }
  /// Returns the higher byte of the sample at an offset in the file; 0 after the end of the file.
  [[nodiscard]] std::uint8_t sample(std::size_t at) const {
    return at < bytes.size() ? std::to_integer<std::uint8_t>(bytes[at]) : std::uint8_t{0};
  }
};

std::variant<SgiFile, ImageError> read_header(std::span<const std::byte> bytes) {
  SgiFile file{bytes};
  if (bytes.size() < kHeader || file.number(0, 2) != 0x01da)
    return ImageError{"broken SGI image: truncated header; expected 512 bytes that begin with 01 da"};
  const std::uint32_t storage = file.number(2, 1), dimension = file.number(4, 2);
  file.sample_bytes = file.number(3, 1);
  if (storage > 1 || file.sample_bytes < 1 || file.sample_bytes > 2 || dimension < 1 || dimension > 3)
    return ImageError{"broken SGI image: storage " + std::to_string(storage) + ", " +
                      std::to_string(file.sample_bytes) + " bytes a component, " + std::to_string(dimension) +
                      " dimensions; expected storage 0 or 1, 1 or 2 bytes and 1 to 3 dimensions"};
  file.compressed = storage == 1;
  file.width = file.number(6, 2);
  file.height = dimension >= 2 ? file.number(8, 2) : 1;
  file.channels = dimension >= 3 ? file.number(10, 2) : 1;
  if (file.channels == 0) return ImageError{"broken SGI image: no channels; expected 1 to 4"};
  // A file of a few bytes must not claim a huge picture.
  constexpr std::size_t kMinPart = 16;
  const std::size_t rows = std::size_t{file.channels} * file.height;
  const std::size_t expected = file.compressed ? 8 * rows : rows * file.width * file.sample_bytes / kMinPart;
  if (bytes.size() - kHeader < expected)
    return ImageError{"broken SGI image: truncated after " + std::to_string(bytes.size()) +
                      " bytes; expected at least " + std::to_string(kHeader + expected)};
  return file;
}

/// Decodes the runs of one row of a channel (RLE). Samples that are missing stay 0.
void decode_runs(const SgiFile& file, std::size_t at, std::size_t length, std::span<std::uint8_t> row) {
  const std::size_t step = file.sample_bytes;
  const std::size_t end = std::min(file.bytes.size(), at + std::min(length, file.bytes.size()));
  std::size_t x = 0;
  while (at + step <= end && x < row.size()) {
    const std::uint32_t code = file.number(at, step) & 0xffU;
    at += step;
    const std::size_t count = std::min<std::size_t>(code & 0x7fU, row.size() - x);
    if (count == 0) return;
    const bool literal = (code & 0x80U) != 0;
    for (std::size_t i = 0; i < count && at + step <= end; ++i) {
      row[x++] = file.sample(at);
      if (literal) at += step;
    }
    if (!literal) at += step;
  }
}

void read_row(const SgiFile& file, std::uint32_t channel, std::uint32_t y, std::span<std::uint8_t> row) {
  const std::size_t index = std::size_t{channel} * file.height + y;
  std::fill(row.begin(), row.end(), std::uint8_t{0});
  if (file.compressed) {
    const std::size_t rows = std::size_t{file.channels} * file.height;
    return decode_runs(file, file.number(kHeader + 4 * index, 4), file.number(kHeader + 4 * (rows + index), 4), row);
  }
  const std::size_t first = kHeader + index * file.width * file.sample_bytes;
  for (std::size_t x = 0; x < row.size(); ++x) row[x] = file.sample(first + x * file.sample_bytes);
}

}  // namespace

DecodedImage decode_sgi(std::span<const std::byte> bytes, const ImageLimits& limits) {
  auto header = read_header(bytes);
  if (auto* error = std::get_if<ImageError>(&header)) return std::move(*error);
  const SgiFile& file = std::get<SgiFile>(header);
  if (auto refused = refuse_size("SGI", file.width, file.height, limits)) return *std::move(refused);
  const std::uint32_t components = std::min(file.channels, 4U);
  Image image;
  RowReducer reducer(image, file.width, file.height, components, reduction_of(file.width, file.height, limits));
  std::vector<std::uint8_t> channel(file.width), row(std::size_t{file.width} * components);
  for (std::uint32_t y = file.height; y-- > 0;) {  // the first row of the file is at the bottom
    if (limits.stopped && limits.stopped()) return ImageError{"cancelled"};
    for (std::uint32_t c = 0; c < components; ++c) {
      read_row(file, c, y, channel);
      for (std::size_t x = 0; x < channel.size(); ++x) row[x * components + c] = channel[x];
    }
    reducer.take(row.data());
  }
  reducer.finish();
  return image;
}

}  // namespace gs::render
