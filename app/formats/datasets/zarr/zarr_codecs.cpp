#include "app/formats/datasets/zarr/zarr_metadata.h"

#include "app/formats/datasets/arrays/dataset_module.h"

#include <isa-l/crc.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

// Decoding of the chunks of Zarr and N5.
namespace gs::app {
namespace {

using ZarrBytes = std::span<const std::byte>;
using DecodedChunk = std::variant<std::vector<std::byte>, std::string>;

std::string damaged_chunk(const char* codec) { return std::string("its bytes are not valid ") + codec + " data"; }

bool is_zarr_compressor(ZarrCodec::Kind kind) {
  return kind != ZarrCodec::Kind::crc32c && kind != ZarrCodec::Kind::shuffle && kind != ZarrCodec::Kind::delta;
}

/// Decompresses with a library of the module. Returns false without the module.
bool unpack_with_module(ChunkCodec codec, ZarrBytes from, std::span<std::byte> out) {
  const auto module = dataset_module();
  const auto* const loaded = std::get_if<const DatasetModule*>(&module);
  return loaded && (*loaded)->unpack(codec, from, out);
}

/// Decompresses to exactly out.size() bytes.
bool unpack_zarr(ZarrCodec::Kind kind, ZarrBytes from, std::span<std::byte> out) {
  switch (kind) {
    case ZarrCodec::Kind::gzip:
      return !unpack_into(from, out, own_budget());
    case ZarrCodec::Kind::zstd:
      return ZSTD_decompress(out.data(), out.size(), from.data(), from.size()) == out.size();
    case ZarrCodec::Kind::blosc:
      return unpack_with_module(ChunkCodec::blosc, from, out);
    case ZarrCodec::Kind::lz4:
      return unpack_with_module(ChunkCodec::lz4, from, out);
    case ZarrCodec::Kind::bzip2:
      return unpack_with_module(ChunkCodec::bzip2, from, out);
    case ZarrCodec::Kind::xz:
      return unpack_with_module(ChunkCodec::xz, from, out);
    case ZarrCodec::Kind::crc32c:
    case ZarrCodec::Kind::shuffle:
    case ZarrCodec::Kind::delta:
      break;
  }
  return false;
}

const char* name_of_codec(ZarrCodec::Kind kind) {
  static constexpr const char* kNames[] = {"gzip", "zstd", "blosc", "lz4", "bzip2", "xz", "crc32c", "shuffle", "delta"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// Undoes the shuffle of numcodecs: all first bytes of the elements, then all second bytes, ...
std::vector<std::byte> unshuffled_bytes(ZarrBytes bytes, std::size_t element) {
  std::vector<std::byte> result(bytes.begin(), bytes.end());
  const std::size_t count = bytes.size() / element;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < element; ++k) result[i * element + k] = bytes[k * count + i];
  return result;
}

/// Undoes the delta of numcodecs: each number becomes the sum of all numbers up to it, modulo 2^n.
template <class Number>
std::vector<std::byte> summed_numbers(ZarrBytes bytes, bool big_endian) {
  const bool swap = sizeof(Number) > 1 && big_endian != (std::endian::native == std::endian::big);
  const auto ordered = [swap](Number number) {
    if (!swap) return number;
    auto parts = std::bit_cast<std::array<std::byte, sizeof(Number)>>(number);
    std::ranges::reverse(parts);
    return std::bit_cast<Number>(parts);
  };
  std::vector<std::byte> result(bytes.begin(), bytes.end());
  Number sum = 0;
  for (std::size_t at = 0; at + sizeof(Number) <= result.size(); at += sizeof(Number)) {
    Number one = 0;
    std::memcpy(&one, &result[at], sizeof one);
    sum = static_cast<Number>(sum + ordered(one));
    one = ordered(sum);
    std::memcpy(&result[at], &one, sizeof one);
  }
  return result;
}

std::vector<std::byte> undone_delta(ZarrBytes bytes, std::size_t element, bool big_endian) {
  if (element == 8) return summed_numbers<std::uint64_t>(bytes, big_endian);
  if (element == 4) return summed_numbers<std::uint32_t>(bytes, big_endian);
  if (element == 2) return summed_numbers<std::uint16_t>(bytes, big_endian);
  return summed_numbers<std::uint8_t>(bytes, big_endian);
}

/// Converts an IEEE 754 binary16 number.
float float_of_half(std::uint16_t half) {
  const unsigned exponent = half >> 10 & 31, fraction = half & 1023;
  const float sign = half >> 15 ? -1.0f : 1.0f;
  if (exponent == 0) return sign * std::ldexp(static_cast<float>(fraction), -24);
  if (exponent == 31)
    return fraction ? std::numeric_limits<float>::quiet_NaN() : sign * std::numeric_limits<float>::infinity();
  return sign * std::ldexp(static_cast<float>(fraction + 1024), static_cast<int>(exponent) - 25);
}

/// Converts halves to floats of the same byte order.
std::vector<std::byte> widened_halves(ZarrBytes halves, bool big_endian) {
  const bool swap = big_endian != (std::endian::native == std::endian::big);
  std::vector<std::byte> result(halves.size() * 2);
  for (std::size_t i = 0; i < halves.size() / 2; ++i) {
    std::uint16_t half = 0;
    std::memcpy(&half, halves.data() + i * 2, sizeof(half));
    if (swap) half = __builtin_bswap16(half);
    auto bits = std::bit_cast<std::uint32_t>(float_of_half(half));
    if (swap) bits = __builtin_bswap32(bits);
    std::memcpy(result.data() + i * 4, &bits, sizeof(bits));
  }
  return result;
}

}  // namespace

std::optional<ZarrBytes> without_crc32c(ZarrBytes bytes) {
  constexpr std::size_t kChecksum = 4;
  if (bytes.size() < kChecksum) return std::nullopt;
  const ZarrBytes content = bytes.first(bytes.size() - kChecksum);
  std::uint32_t stored = 0;
  for (std::size_t i = kChecksum; i-- > 0;)
    stored = stored << 8 | std::to_integer<std::uint32_t>(bytes[content.size() + i]);
  // crc32_iscsi() takes a pointer without const and an int, and inverts neither the first nor the last value.
  std::uint32_t crc = 0xffffffff;
  for (std::size_t at = 0; at < content.size();) {
    const std::size_t piece = std::min<std::size_t>(content.size() - at, std::size_t{1} << 30);
    auto* const from = const_cast<unsigned char*>(reinterpret_cast<const unsigned char*>(content.data() + at));
    crc = crc32_iscsi(from, static_cast<int>(piece), crc);
    at += piece;
  }
  return ~crc == stored ? std::optional(content) : std::nullopt;
}

DecodedChunk decode_zarr_chunk(const ZarrArray& array, ZarrBytes bytes, std::uint64_t elements) {
  const std::size_t expected = static_cast<std::size_t>(elements) * array.type.encoded_bytes();
  // Sizes before each codec of the encoder. Only the last compressor may change a size to an unknown one.
  std::vector<std::size_t> sizes;
  std::size_t size = expected;
  bool known = true;
  for (const ZarrCodec& codec : array.codecs) {
    if (!known && is_zarr_compressor(codec.kind)) return std::string("it is compressed twice; expected one compressor");
    sizes.push_back(known ? size : 0);
    if (is_zarr_compressor(codec.kind)) known = false;
    if (codec.kind == ZarrCodec::Kind::crc32c) size += 4;
  }
  std::vector<std::byte> held;
  for (std::size_t i = array.codecs.size(); i-- > 0;) {
    const ZarrCodec& codec = array.codecs[i];
    if (codec.kind == ZarrCodec::Kind::crc32c) {
      const auto content = without_crc32c(bytes);
      if (!content) return std::string("its checksum differs");
      bytes = *content;
    } else if (codec.kind == ZarrCodec::Kind::shuffle) {
      held = unshuffled_bytes(bytes, codec.element);
      bytes = held;
    } else if (codec.kind == ZarrCodec::Kind::delta) {
      held = undone_delta(bytes, codec.element, array.type.big_endian);
      bytes = held;
    } else {
      std::vector<std::byte> unpacked(sizes[i]);
      if (!unpack_zarr(codec.kind, bytes, unpacked)) return damaged_chunk(name_of_codec(codec.kind));
      held = std::move(unpacked);
      bytes = held;
    }
  }
  if (bytes.size() < expected)
    return "it has " + std::to_string(bytes.size()) + " bytes; expected " + std::to_string(expected);
  bytes = bytes.first(expected);
  if (array.type.half) return widened_halves(bytes, array.type.big_endian);
  if (bytes.data() == held.data() && held.size() == expected) return held;
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

}  // namespace gs::app
