#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <vector>

// Access to the bytes of QNV streams (FORMAT.md), for mutations.
namespace gs::fuzz {

inline constexpr std::size_t kFixedHeader = 108, kHeaderLength = 12, kHeaderSum = 16, kSectionHead = 6, kChunkHead = 10;

inline std::uint32_t number_at(const std::vector<std::uint8_t>& bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value |= static_cast<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

inline void put_number(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value, std::size_t size) {
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
    bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

/// Corrects the checksums of the header and of the chunks. Stops at the first length that leads to no further chunk.
inline void mend_checksums(std::vector<std::uint8_t>& bytes) {
  const auto checksum = [](std::uint32_t from, const std::uint8_t* first, std::size_t size) {
    return static_cast<std::uint32_t>(crc32_z(from, first, size));
  };
  if (bytes.size() < kFixedHeader) return;
  const std::size_t header = number_at(bytes, kHeaderLength, 4);
  if (header > bytes.size() || header < kFixedHeader) return;
  put_number(bytes, kHeaderSum, 0, 4);
  put_number(bytes, kHeaderSum, checksum(0, bytes.data(), header), 4);
  for (std::size_t at = header; at + kChunkHead <= bytes.size();) {
    const std::size_t payload = number_at(bytes, at + 2, 2);
    if (payload > bytes.size() - at - kChunkHead) return;
    put_number(bytes, at + 6, checksum(checksum(0, bytes.data() + at, 6), bytes.data() + at + kChunkHead, payload), 4);
    at += kChunkHead + payload;
  }
}

}  // namespace gs::fuzz
