#include "app/formats/datasets/module/hdf5_filters.h"

#include <hdf5.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include <blosc.h>
#include <lz4.h>
#include <zstd.h>

// Filters of HDF5 (https://github.com/HDFGroup/hdf5_plugins), for decoding only.

namespace gs::app {
namespace {

using FilterBytes = std::span<const unsigned char>;

constexpr std::size_t kMostChunk = std::size_t{1} << 32;  // HDF5 itself limits chunks to this size

/// Memory that HDF5 frees, with its size.
struct FilterOutput {
  unsigned char* bytes = nullptr;
  std::size_t size = 0;
};

/// Allocates a decoded chunk. A chunk of `packed` bytes cannot expand more than `ratio` times.
FilterOutput filter_output(std::uint64_t size, std::size_t packed, std::uint64_t ratio) {
  if (size == 0 || size > kMostChunk || size / ratio > packed + 1) return {};
  return {static_cast<unsigned char*>(H5allocate_memory(static_cast<std::size_t>(size), false)),
          static_cast<std::size_t>(size)};
}

std::uint64_t big_endian(FilterBytes bytes) {
  std::uint64_t value = 0;
  for (const unsigned char byte : bytes) value = value << 8 | byte;
  return value;
}

/// Decodes LZF (http://oldhome.schmorp.de/marc/liblzf.html). Returns false for damaged data.
bool decode_lzf(FilterBytes from, std::span<unsigned char> to, std::size_t& made) {
  constexpr std::size_t kLiterals = 32, kLongMatch = 7;
  made = 0;
  for (std::size_t at = 0; at < from.size();) {
    const std::size_t control = from[at++];
    if (control < kLiterals) {
      const std::size_t count = control + 1;
      if (count > from.size() - at || count > to.size() - made) return false;
      std::memcpy(to.data() + made, from.data() + at, count);
      at += count;
      made += count;
      continue;
    }
    std::size_t count = control >> 5, back = (control & 31) << 8;
    if (count == kLongMatch) {
      if (at >= from.size()) return false;
      count += from[at++];
    }
    if (at >= from.size()) return false;
    back += from[at++] + std::size_t{1};
    count += 2;
    if (back > made || count > to.size() - made) return false;
    for (std::size_t i = 0; i < count; ++i, ++made) to[made] = to[made - back];  // may overlap
  }
  return true;
}

FilterOutput decode_lzf_chunk(FilterBytes from, std::span<const unsigned> values) {
  constexpr std::uint64_t kMostRatio = 132;
  // The third value is the size of a chunk.
  FilterOutput out = filter_output(values.size() > 2 ? values[2] : 0, from.size(), kMostRatio);
  if (out.bytes && decode_lzf(from, {out.bytes, out.size}, out.size)) return out;
  if (out.bytes) (void)H5free_memory(out.bytes);
  return {};
}

FilterOutput decode_zstd_chunk(FilterBytes from, std::span<const unsigned>) {
  constexpr std::uint64_t kMostRatio = 1 << 17;
  const unsigned long long size = ZSTD_getFrameContentSize(from.data(), from.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) return {};
  const FilterOutput out = filter_output(size, from.size(), kMostRatio);
  if (out.bytes && ZSTD_decompress(out.bytes, out.size, from.data(), from.size()) == out.size) return out;
  if (out.bytes) (void)H5free_memory(out.bytes);
  return {};
}

FilterOutput decode_blosc_chunk(FilterBytes from, std::span<const unsigned>) {
  constexpr std::uint64_t kMostRatio = 1 << 17;
  std::size_t size = 0;
  if (blosc_cbuffer_validate(from.data(), from.size(), &size) < 0) return {};
  const FilterOutput out = filter_output(size, from.size(), kMostRatio);
  if (out.bytes && blosc_decompress_ctx(from.data(), out.bytes, out.size, 1) == static_cast<int>(out.size)) return out;
  if (out.bytes) (void)H5free_memory(out.bytes);
  return {};
}

FilterOutput decode_lz4_chunk(FilterBytes from, std::span<const unsigned>) {
  // The size of the chunk (8 bytes) and of a block (4 bytes), then blocks: the packed size (4 bytes) and the data. All
  // numbers are big-endian. A block of its full size is not packed.
  constexpr std::size_t kHead = 12, kBlockHead = 4;
  constexpr std::uint64_t kMostRatio = 256;
  if (from.size() < kHead) return {};
  const std::uint64_t size = big_endian(from.first(8)), block = big_endian(from.subspan(8, 4));
  const FilterOutput out =
      block > 0 && block < (1u << 31) ? filter_output(size, from.size(), kMostRatio) : FilterOutput();
  std::size_t at = kHead, made = 0;
  bool good = out.bytes != nullptr;
  while (good && made < out.size) {
    if (from.size() - at < kBlockHead) {
      good = false;
      break;
    }
    const std::uint64_t packed = big_endian(from.subspan(at, kBlockHead));
    at += kBlockHead;
    const std::size_t wanted = std::min(static_cast<std::size_t>(block), out.size - made);
    good = packed <= from.size() - at && packed < (1u << 31);
    if (!good) break;
    if (packed == wanted)
      std::memcpy(out.bytes + made, from.data() + at, wanted);
    else
      good = LZ4_decompress_safe(reinterpret_cast<const char*>(from.data() + at),
                                 reinterpret_cast<char*>(out.bytes + made), static_cast<int>(packed),
                                 static_cast<int>(wanted)) == static_cast<int>(wanted);
    at += static_cast<std::size_t>(packed);
    made += wanted;
  }
  if (good) return out;
  if (out.bytes) (void)H5free_memory(out.bytes);
  return {};
}

/// Filter function of HDF5. Returns 0 on failure, also for encoding.
template <FilterOutput (*decode)(FilterBytes from, std::span<const unsigned> values)>
std::size_t filter_chunk(unsigned flags, std::size_t count, const unsigned* values, std::size_t bytes,
                         std::size_t* size, void** buffer) noexcept {
  if ((flags & H5Z_FLAG_REVERSE) == 0) return 0;
  const FilterOutput out = decode({static_cast<const unsigned char*>(*buffer), bytes}, {values, count});
  if (!out.bytes) return 0;
  (void)H5free_memory(*buffer);
  *buffer = out.bytes;
  *size = out.size;
  return out.size;
}

constexpr H5Z_class2_t kFilters[] = {
    {H5Z_CLASS_T_VERS, 32000, 0, 1, "LZF", nullptr, nullptr, filter_chunk<decode_lzf_chunk>},
    {H5Z_CLASS_T_VERS, 32001, 0, 1, "Blosc", nullptr, nullptr, filter_chunk<decode_blosc_chunk>},
    {H5Z_CLASS_T_VERS, 32004, 0, 1, "LZ4", nullptr, nullptr, filter_chunk<decode_lz4_chunk>},
    {H5Z_CLASS_T_VERS, 32015, 0, 1, "Zstandard", nullptr, nullptr, filter_chunk<decode_zstd_chunk>},
};

}  // namespace

void register_hdf5_filters() {
  for (const H5Z_class2_t& filter : kFilters) (void)H5Zregister(&filter);
}

}  // namespace gs::app
