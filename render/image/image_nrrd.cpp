// Decoder of NRRD files as textures (X3D ImageTexture3D): integers and floats, raw, ascii, hex or gzip.
// https://teem.sourceforge.net/nrrd/format.html
#include "base/gzip.h"
#include "render/image/image_codecs.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

namespace gs::render {
namespace {

struct NrrdHeader {
  std::string type, encoding = "raw", endian = "little";
  std::vector<std::uint64_t> sizes;
  std::size_t end = 0;  // offset of the data
};

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\r')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

NrrdHeader read_nrrd_header(std::string_view text) {
  NrrdHeader header;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t stop = std::min(text.find('\n', at), text.size());
    const std::string_view line = without_blanks(text.substr(at, stop - at));
    at = std::min(stop + 1, text.size());
    if (line.empty()) break;
    const std::size_t colon = line.find(':');
    if (line.front() == '#' || colon == line.npos) continue;
    const std::string_view name = without_blanks(line.substr(0, colon)), value = without_blanks(line.substr(colon + 1));
    if (name == "type") header.type = value;
    if (name == "encoding") header.encoding = value;
    if (name == "endian") header.endian = value;
    if (name != "sizes") continue;
    const char *next = value.data(), *end = next + value.size();
    for (std::uint64_t size = 0; next < end && header.sizes.size() < 8;) {
      while (next < end && *next == ' ') ++next;
      const auto read = std::from_chars(next, end, size);
      if (read.ec != std::errc()) break;
      header.sizes.push_back(size);
      next = read.ptr;
    }
  }
  header.end = at;
  return header;
}

/// Number type of samples.
enum class NrrdType : std::uint8_t { u8, i8, u16, i16, f32, unknown };
std::size_t nrrd_bytes_of(NrrdType type) {
  return type == NrrdType::f32 ? 4 : type == NrrdType::u16 || type == NrrdType::i16 ? 2 : 1;
}

NrrdType nrrd_type_of(std::string_view name) {
  for (const char* one : {"uchar", "unsigned char", "uint8", "uint8_t"})
    if (name == one) return NrrdType::u8;
  for (const char* one : {"signed char", "int8", "int8_t"})
    if (name == one) return NrrdType::i8;
  for (const char* one : {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"})
    if (name == one) return NrrdType::u16;
  for (const char* one : {"short", "short int", "signed short", "int16", "int16_t"})
    if (name == one) return NrrdType::i16;
  return name == "float" ? NrrdType::f32 : NrrdType::unknown;
}

/// Returns the samples of a text: decimal numbers, or pairs of hexadecimal digits.
std::vector<double> samples_of_text(std::string_view text, bool hexadecimal, std::size_t count) {
  std::vector<double> samples;
  samples.reserve(count);
  const char *next = text.data(), *end = next + text.size();
  while (samples.size() < count) {
    while (next < end && static_cast<unsigned char>(*next) <= ' ') ++next;
    if (hexadecimal) {
      unsigned value = 0;
      const auto read = std::from_chars(next, std::min(next + 2, end), value, 16);
      if (read.ec != std::errc()) break;
      samples.push_back(value);
      next = read.ptr;
    } else {
      double value = 0;
      const auto read = std::from_chars(next, end, value);
      if (read.ec != std::errc()) break;
      samples.push_back(value);
      next = read.ptr;
    }
  }
  return samples;
}

/// Samples of a file: numbers of a text, or bytes. There are fewer than the header says if the data ends early.
struct NrrdSamples {
  std::vector<double> numbers;
  std::vector<std::byte> unpacked;
  std::span<const std::byte> bytes;  // of the file, or `unpacked`
  NrrdType type = NrrdType::f32;
  bool is_text = false, big = false;

  [[nodiscard]] std::size_t count() const {
    return is_text ? numbers.size() : bytes.size() / nrrd_bytes_of(type);
  }
  [[nodiscard]] double at(std::size_t i) const {
    if (is_text) return numbers[i];
    if (type == NrrdType::u8) return static_cast<double>(bytes[i]);
    const std::size_t size = nrrd_bytes_of(type);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < size; ++k)
      word |= std::uint32_t{static_cast<std::uint8_t>(bytes[i * size + (big ? size - 1 - k : k)])} << (8 * k);
    float number = 0;
    if (type == NrrdType::f32) std::memcpy(&number, &word, sizeof number);
    return type == NrrdType::f32   ? double{number}
           : type == NrrdType::i8  ? static_cast<std::int8_t>(word)
           : type == NrrdType::i16 ? static_cast<std::int16_t>(word)
                                   : static_cast<double>(word);
  }
};

/// Scale of samples to bytes: unsigned bytes stay as they are, others reach from their smallest to their largest value.
struct ByteScale {
  double low = 0, factor = 1;
  ByteScale(const NrrdSamples& samples, std::size_t count) {
    if (samples.type == NrrdType::u8) return;
    double high = -HUGE_VAL;
    low = HUGE_VAL;
    for (std::size_t i = 0; i < count; ++i)
      if (const double sample = samples.at(i); std::isfinite(sample))
        low = std::min(low, sample), high = std::max(high, sample);
    factor = high > low ? 255 / (high - low) : 0;
  }
  [[nodiscard]] std::uint8_t operator()(double sample) const {
    return std::isfinite(sample) ? static_cast<std::uint8_t>(std::clamp((sample - low) * factor, 0.0, 255.0)) : 0;
  }
};

/// Finds the samples of the data. Returns an error for an unknown encoding, or if they need too much memory.
std::variant<NrrdSamples, ImageError> samples_of(std::span<const std::byte> data, const NrrdHeader& header,
                                                 NrrdType type, std::size_t count, std::size_t working_bytes) {
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  const std::string& encoding = header.encoding;
  NrrdSamples samples;
  samples.type = type;
  samples.big = header.endian == "big";
  const std::size_t most = count * nrrd_bytes_of(type);
  const bool hexadecimal = encoding == "hex", packed = encoding == "gzip" || encoding == "gz";
  samples.is_text = hexadecimal || encoding == "ascii" || encoding == "text" || encoding == "txt";
  if ((samples.is_text ? count * sizeof(double) : packed ? most : 0) > working_bytes)
    return ImageError{"NRRD of " + std::to_string(count) + " samples; expected at most " +
                      std::to_string(working_bytes) + " bytes of them"};
  if (samples.is_text) {
    samples.numbers = samples_of_text(text, hexadecimal, count);
    return samples;
  }
  if (!packed && encoding != "raw")
    return ImageError{"NRRD encoding '" + encoding + "'; expected raw, ascii, hex or gzip"};
  samples.bytes = data.first(std::min(data.size(), most));
  if (!packed) return samples;
  (void)gunzip(data, std::make_shared<Budget>(), [&](std::string_view piece) {
    const auto* first = reinterpret_cast<const std::byte*>(piece.data());
    samples.unpacked.insert(samples.unpacked.end(), first,
                            first + std::min(piece.size(), most - samples.unpacked.size()));
    return samples.unpacked.size() < most;
  });
  samples.bytes = samples.unpacked;
  return samples;
}

/// Writes the components of a reduced voxel: means over a cube of `side` voxels from `at` on. Missing samples are 0.
void put_voxel(const NrrdSamples& samples, const ByteScale& scale, const std::array<std::uint64_t, 3>& sizes,
               std::uint64_t components, const std::array<std::uint64_t, 3>& at, std::uint64_t side,
               std::vector<std::uint8_t>& to) {
  const std::size_t available = samples.count();
  std::array<std::uint64_t, 3> end{};
  for (std::size_t i = 0; i < 3; ++i) end[i] = std::min(at[i] + side, sizes[i]);
  for (std::uint64_t c = 0; c < components; ++c) {
    std::uint64_t sum = 0, number = 0;
    for (std::uint64_t z = at[2]; z < end[2]; ++z)
      for (std::uint64_t y = at[1]; y < end[1]; ++y)
        for (std::uint64_t x = at[0]; x < end[0]; ++x) {
          const std::uint64_t sample = ((z * sizes[1] + y) * sizes[0] + x) * components + c;
          sum += sample < available ? scale(samples.at(sample)) : 0;
          ++number;
        }
    to.push_back(static_cast<std::uint8_t>(sum / std::max<std::uint64_t>(number, 1)));
  }
}

}  // namespace

DecodedImage decode_nrrd(std::span<const std::byte> bytes, const ImageLimits& limits) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const NrrdHeader header = read_nrrd_header(text.substr(0, std::min<std::size_t>(text.size(), 1 << 16)));
  const NrrdType type = nrrd_type_of(header.type);
  if (type == NrrdType::unknown) return ImageError{"NRRD type '" + header.type + "'; expected 8 or 16 bits, or float"};
  const std::vector<std::uint64_t>& sizes = header.sizes;
  if (sizes.size() != 3 && sizes.size() != 4)
    return ImageError{"NRRD of " + std::to_string(sizes.size()) +
                      " dimensions; expected 3, or 4 with components first"};
  const std::uint64_t components = sizes.size() == 4 ? sizes[0] : 1;
  const std::size_t first = sizes.size() - 3;
  if (components < 1 || components > 4)
    return ImageError{"NRRD with " + std::to_string(components) + " components; expected 1 to 4"};
  constexpr std::uint64_t kMaxSide = 4096;
  for (std::size_t i = first; i < sizes.size(); ++i)
    if (sizes[i] < 1 || sizes[i] > kMaxSide)
      return ImageError{"NRRD with a side of " + std::to_string(sizes[i]) + "; expected 1 to 4096"};
  const std::array<std::uint64_t, 3> whole{sizes[first], sizes[first + 1], sizes[first + 2]};
  const std::uint64_t voxels = whole[0] * whole[1] * whole[2], count = voxels * components;
  if (voxels > limits.file_pixels)
    return ImageError{"NRRD of " + std::to_string(voxels) + " voxels; expected at most " +
                      std::to_string(limits.file_pixels)};
  // Larger volumes are reduced by a whole number in each direction.
  std::uint64_t side = 1;
  const auto kept = [&](std::size_t i) { return (whole[i] + side - 1) / side; };
  while (side < kMaxSide && kept(0) * kept(1) * kept(2) > std::max<std::size_t>(limits.kept_pixels, 1)) ++side;
  auto found = samples_of(bytes.subspan(header.end), header, type, count, limits.working_bytes);
  if (auto* error = std::get_if<ImageError>(&found)) return std::move(*error);
  NrrdSamples& samples = std::get<0>(found);
  if (!samples.unpacked.empty()) samples.bytes = samples.unpacked;  // the vector has moved
  const ByteScale scale(samples, std::min<std::size_t>(samples.count(), count));
  Image image{static_cast<std::uint32_t>(kept(0)),
              static_cast<std::uint32_t>(kept(1) * kept(2)),
              static_cast<std::uint32_t>(components),
              {}};
  image.slices = static_cast<std::uint32_t>(kept(2));
  image.reduction = static_cast<std::uint32_t>(side);
  image.pixels.reserve(kept(0) * kept(1) * kept(2) * components);
  // The first row of a slice is at t = 0, the bottom.
  for (std::uint64_t z = 0; z < kept(2); ++z) {
    if (limits.stopped && limits.stopped()) return ImageError{"cancelled"};
    for (std::uint64_t row = kept(1); row-- > 0;)
      for (std::uint64_t x = 0; x < kept(0); ++x)
        put_voxel(samples, scale, whole, components, {x * side, row * side, z * side}, side, image.pixels);
  }
  return image;
}

}  // namespace gs::render
