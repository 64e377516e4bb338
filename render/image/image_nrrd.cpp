// Decoder of NRRD files as textures (X3D ImageTexture3D): integers and floats, raw, ascii, hex or gzip.
// https://teem.sourceforge.net/nrrd/format.html
#include "base/gzip.h"
#include "render/image/image_codecs.h"

#include <algorithm>
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

std::vector<double> samples_of_bytes(std::span<const std::byte> bytes, NrrdType type, bool big, std::size_t count) {
  const std::size_t size = nrrd_bytes_of(type);
  count = std::min(count, bytes.size() / size);
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < size; ++k)
      word |= std::uint32_t{static_cast<std::uint8_t>(bytes[i * size + (big ? size - 1 - k : k)])} << (8 * k);
    float number = 0;
    if (type == NrrdType::f32) std::memcpy(&number, &word, sizeof number);
    samples[i] = type == NrrdType::f32   ? double{number}
                 : type == NrrdType::i8  ? static_cast<std::int8_t>(word)
                 : type == NrrdType::i16 ? static_cast<std::int16_t>(word)
                                         : static_cast<double>(word);
  }
  return samples;
}

/// Scales samples to bytes: unsigned bytes as they are, others from their smallest to their largest value.
std::vector<std::uint8_t> bytes_from(const std::vector<double>& samples, NrrdType type) {
  double low = 0, high = 255;
  if (type != NrrdType::u8) {
    low = HUGE_VAL, high = -HUGE_VAL;
    for (const double sample : samples)
      if (std::isfinite(sample)) low = std::min(low, sample), high = std::max(high, sample);
  }
  const double scale = high > low ? 255 / (high - low) : 0;
  std::vector<std::uint8_t> result;
  result.reserve(samples.size());
  for (const double sample : samples)
    result.push_back(std::isfinite(sample) ? static_cast<std::uint8_t>(std::clamp((sample - low) * scale, 0.0, 255.0))
                                           : 0);
  return result;
}

/// Returns the samples, fewer than `count` if the data ends early. The error names an unknown encoding.
std::variant<std::vector<double>, ImageError> samples_of(std::span<const std::byte> data, const NrrdHeader& header,
                                                         NrrdType type, std::size_t count) {
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  const std::string& encoding = header.encoding;
  if (encoding == "ascii" || encoding == "text" || encoding == "txt") return samples_of_text(text, false, count);
  if (encoding == "hex") return samples_of_text(text, true, count);
  const bool big = header.endian == "big";
  if (encoding == "raw") return samples_of_bytes(data, type, big, count);
  if (encoding != "gzip" && encoding != "gz")
    return ImageError{"NRRD encoding '" + encoding + "'; expected raw, ascii, hex or gzip"};
  std::vector<std::byte> unpacked;
  const std::size_t most = count * nrrd_bytes_of(type);
  (void)gunzip(data, std::make_shared<Budget>(), [&](std::string_view piece) {
    const auto* first = reinterpret_cast<const std::byte*>(piece.data());
    unpacked.insert(unpacked.end(), first, first + std::min(piece.size(), most - unpacked.size()));
    return unpacked.size() < most;
  });
  return samples_of_bytes(unpacked, type, big, count);
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
  const std::uint64_t width = sizes[first], height = sizes[first + 1], depth = sizes[first + 2];
  const std::uint64_t voxels = width * height * depth, count = voxels * components;
  if (voxels > limits.kept_pixels || count * (sizeof(double) + 2) > limits.working_bytes)
    return ImageError{"NRRD of " + std::to_string(voxels) + " voxels; expected at most " +
                      std::to_string(limits.kept_pixels)};
  auto samples = samples_of(bytes.subspan(header.end), header, type, count);
  if (auto* error = std::get_if<ImageError>(&samples)) return std::move(*error);
  std::vector<std::uint8_t> values = bytes_from(std::get<0>(samples), type);
  values.resize(count);  // missing samples are black
  Image image{static_cast<std::uint32_t>(width),
              static_cast<std::uint32_t>(height * depth),
              static_cast<std::uint32_t>(components),
              {}};
  image.slices = static_cast<std::uint32_t>(depth);
  image.pixels.reserve(count);
  // The first row of a slice is at t = 0, the bottom.
  for (std::uint64_t z = 0; z < depth; ++z)
    for (std::uint64_t row = height; row-- > 0;) {
      const auto from = values.begin() + static_cast<std::ptrdiff_t>((z * height + row) * width * components);
      image.pixels.insert(image.pixels.end(), from, from + static_cast<std::ptrdiff_t>(width * components));
    }
  return image;
}

}  // namespace gs::render
