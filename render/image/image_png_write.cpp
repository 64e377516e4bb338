#include "base/parallel.h"
#include "render/image/image_codecs.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

// Encoder of PNG (ISO/IEC 15948) with several threads. They filter and compress strips of rows in parallel. The deflate
// blocks of a strip end on a byte and do not refer to earlier data, so strips can be concatenated.
namespace gs::render {
namespace {

constexpr std::size_t kStripRows = 64;
enum RowFilter : std::uint8_t { kUnfiltered, kFromLeft, kFromAbove, kFromBoth, kPaethOf, kRowFilters };

std::uint8_t paeth(int left, int up, int corner) {
  const int from_left = std::abs(up - corner), from_up = std::abs(left - corner),
            from_corner = std::abs(left + up - 2 * corner);
  return static_cast<std::uint8_t>(from_left <= from_up && from_left <= from_corner ? left
                                   : from_up <= from_corner                         ? up
                                                                                    : corner);
}

/// Applies a PNG filter to a row. `row` and `above` must have `pixel` zero bytes before them.
void filter_row(RowFilter filter, const std::uint8_t* row, const std::uint8_t* above, std::size_t count,
                std::size_t pixel, std::uint8_t* to) {
  const std::uint8_t *left = row - pixel, *corner = above - pixel;
  const auto each = [&](const auto& predicted) {
    for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<std::uint8_t>(row[i] - predicted(i));
  };
  switch (filter) {
    case kFromLeft:
      return each([&](std::size_t i) { return left[i]; });
    case kFromAbove:
      return each([&](std::size_t i) { return above[i]; });
    case kFromBoth:
      return each([&](std::size_t i) { return (left[i] + above[i]) / 2; });
    case kPaethOf:
      return each([&](std::size_t i) { return paeth(left[i], above[i], corner[i]); });
    default:
      return each([](std::size_t) { return 0; });
  }
}

/// Estimates how badly a row compresses: the sum of the distances of its bytes from 0, as in libpng.
std::size_t row_roughness(const std::vector<std::uint8_t>& bytes) {
  std::uint32_t sum = 0;  // no overflow: fewer than 2^25 bytes with a distance of at most 128
  for (const std::uint8_t byte : bytes) sum += std::min(byte, static_cast<std::uint8_t>(-byte));
  return sum;
}

struct PngStrip {
  std::vector<std::uint8_t> compressed;
  uLong checksum = 0;  // Adler-32 checksum of `bytes` bytes
  std::size_t bytes = 0;
};

void compress_strip(const std::vector<std::uint8_t>& filtered, bool last, PngStrip& strip) {
  strip.bytes = filtered.size();
  strip.checksum = adler32(adler32(0, nullptr, 0), filtered.data(), static_cast<uInt>(filtered.size()));
  z_stream stream{};
  // These settings take a third of the default's time, for files that are a tenth larger (docs/benchmarks.md).
  if (deflateInit2(&stream, 1, Z_DEFLATED, -MAX_WBITS, 8, Z_RLE) != Z_OK) throw std::bad_alloc();
  constexpr std::size_t kFlush = 64;  // additional bytes for the end of the deflate blocks
  try {
    strip.compressed.resize(deflateBound(&stream, static_cast<uLong>(filtered.size())) + kFlush);
  } catch (...) {
    deflateEnd(&stream);
    throw;
  }
  stream.next_in = const_cast<Bytef*>(filtered.data());
  stream.avail_in = static_cast<uInt>(filtered.size());
  stream.next_out = strip.compressed.data();
  stream.avail_out = static_cast<uInt>(strip.compressed.size());
  (void)deflate(&stream, last ? Z_FINISH : Z_FULL_FLUSH);
  strip.compressed.resize(stream.total_out);
  deflateEnd(&stream);
}

/// Filters and compresses rows. `before` is the row above the image's first row; empty means that there is none.
PngStrip encode_strip(const Image& image, std::size_t first, std::size_t end, bool last,
                      const std::vector<std::uint8_t>& before) {
  const std::size_t pixel = image.components, count = std::size_t{image.width} * pixel;
  // Pixels left of the first column and above the first row count as 0.
  std::vector<std::uint8_t> above(pixel + count), row(pixel + count), filtered;
  filtered.reserve((end - first) * (count + 1));
  const auto load = [&](std::size_t y, std::vector<std::uint8_t>& to) {
    std::copy_n(image.pixels.data() + y * count, count, to.begin() + static_cast<std::ptrdiff_t>(pixel));
  };
  if (first > 0) load(first - 1, above);
  if (first == 0) std::copy(before.begin(), before.end(), above.begin() + static_cast<std::ptrdiff_t>(pixel));
  std::vector<std::uint8_t> best(count), tried(count);
  for (std::size_t y = first; y < end; ++y) {
    load(y, row);
    std::uint8_t chosen = kUnfiltered;
    std::size_t least = SIZE_MAX;
    for (std::uint8_t filter = kUnfiltered; filter < kRowFilters && least > 0; ++filter) {
      filter_row(static_cast<RowFilter>(filter), row.data() + pixel, above.data() + pixel, count, pixel, tried.data());
      if (const std::size_t sum = row_roughness(tried); sum < least) {
        least = sum;
        chosen = filter;
        best.swap(tried);
      }
    }
    filtered.push_back(chosen);
    filtered.insert(filtered.end(), best.begin(), best.end());
    row.swap(above);
  }
  PngStrip strip;
  compress_strip(filtered, last, strip);
  return strip;
}

class PngChunks {
 public:
  explicit PngChunks(std::vector<std::byte>& bytes) : bytes_(bytes) {}
  void number(std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes_.push_back(static_cast<std::byte>(value >> shift));
  }
  void bytes(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  void begin(std::string_view type, std::size_t size) {
    number(static_cast<std::uint32_t>(size));
    start_ = bytes_.size();
    bytes(type.data(), type.size());
  }
  void end() {
    const auto* first = reinterpret_cast<const Bytef*>(bytes_.data() + start_);
    number(static_cast<std::uint32_t>(crc32_z(crc32(0, nullptr, 0), first, bytes_.size() - start_)));
  }

 private:
  std::vector<std::byte>& bytes_;
  std::size_t start_ = 0;
};

}  // namespace

PngWriter::PngWriter(std::uint32_t width, std::uint32_t height, std::uint32_t components, double dots_per_inch)
    : width_(width), height_(height), components_(components) {
  // A strip must fit into the counters of zlib, and a chunk into those of PNG.
  constexpr std::uint64_t kMax = std::uint64_t{1} << 31;
  good_ =
      components >= 1 && components <= 4 && width > 0 && height > 0 && width < kMax / 4 / kStripRows && height < kMax;
  if (!good_) return;
  static constexpr std::array<unsigned char, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  static constexpr std::array<unsigned char, 4> kColorTypes = {0, 4, 2, 6};  // grey, grey and alpha, RGB, RGBA
  PngChunks writer(bytes_);
  writer.bytes(kSignature.data(), kSignature.size());
  writer.begin("IHDR", 13);
  writer.number(width);
  writer.number(height);
  const std::array<unsigned char, 5> rest = {8, kColorTypes[components - 1], 0, 0, 0};
  writer.bytes(rest.data(), rest.size());
  writer.end();
  constexpr double kInch = 0.0254;  // inch in metres
  if (dots_per_inch > 0) {
    static constexpr unsigned char kMetres = 1;
    const auto dots = static_cast<std::uint32_t>(std::lround(std::min(dots_per_inch / kInch, 2e9)));
    writer.begin("pHYs", 9);
    writer.number(dots);
    writer.number(dots);
    writer.bytes(&kMetres, 1);
    writer.end();
  }
}

void PngWriter::add(const Image& band) {
  good_ = good_ && band.width == width_ && band.components == components_ && band.height > 0 &&
          band.height <= height_ - rows_ &&
          band.pixels.size() == std::uint64_t{band.width} * band.height * band.components;
  if (!good_) return;
  const bool starts = rows_ == 0;
  rows_ += band.height;
  const bool ends = rows_ == height_;
  std::vector<PngStrip> strips((band.height + kStripRows - 1) / kStripRows);
  (void)parallel_for(strips.size(), [&](std::size_t i) {
    strips[i] = encode_strip(band, i * kStripRows, std::min<std::size_t>(band.height, (i + 1) * kStripRows),
                             ends && i + 1 == strips.size(), above_);
  });
  above_.assign(band.pixels.end() - std::ptrdiff_t{width_} * components_, band.pixels.end());
  static constexpr std::array<unsigned char, 2> kZlibHeader = {0x78, 0x01};
  PngChunks writer(bytes_);
  for (std::size_t i = 0; i < strips.size(); ++i) {
    const PngStrip& strip = strips[i];
    checksum_ =
        static_cast<std::uint32_t>(adler32_combine(checksum_, strip.checksum, static_cast<z_off_t>(strip.bytes)));
    const bool first = starts && i == 0, last = ends && i + 1 == strips.size();
    writer.begin("IDAT", strip.compressed.size() + (first ? kZlibHeader.size() : 0) + (last ? 4 : 0));
    if (first) writer.bytes(kZlibHeader.data(), kZlibHeader.size());
    writer.bytes(strip.compressed.data(), strip.compressed.size());
    if (last) writer.number(checksum_);
    writer.end();
  }
}

std::vector<std::byte> PngWriter::finish() {
  if (!good_ || rows_ != height_) return {};
  PngChunks writer(bytes_);
  writer.begin("IEND", 0);
  writer.end();
  good_ = false;
  return std::move(bytes_);
}

std::vector<std::byte> encode_png(const Image& image, double dots_per_inch) {
  PngWriter writer(image.width, image.height, image.components, dots_per_inch);
  writer.add(image);
  return writer.finish();
}

}  // namespace gs::render
