#pragma once

#include "base/bytes.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Writes a number as bytes of 7 bits each, lowest first; bit 7 marks that another byte follows.
inline void put_number(std::vector<std::byte>& out, std::uint64_t value) {
  for (; value >= 128; value >>= 7) out.push_back(static_cast<std::byte>((value & 127) | 128));
  out.push_back(static_cast<std::byte>(value));
}

/// Reads a number below 2^28 that put_number() wrote. Returns 0xffffffff if all four bytes have bit 7 set. If the bytes
/// end early, returns 0, and `reader` is no longer good().
[[nodiscard]] inline std::uint32_t get_number(ByteReader& reader) {
  std::uint32_t value = 0;
  for (int shift = 0; shift < 28; shift += 7) {
    const auto byte = reader.integer<std::uint8_t>();
    value |= static_cast<std::uint32_t>(byte & 127) << shift;
    if (byte < 128) return value;
  }
  return 0xffffffff;
}

/// Takes a number below 2^42, which put_number() wrote, from the front of `bytes`. Returns nullopt if it is larger or
/// truncated.
[[nodiscard]] inline std::optional<std::uint64_t> take_wide_number(std::span<const std::byte>& bytes) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 42 && !bytes.empty(); shift += 7) {
    const auto byte = std::to_integer<std::uint64_t>(bytes.front());
    bytes = bytes.subspan(1);
    value |= (byte & 127) << shift;
    if (byte < 128) return value;
  }
  return std::nullopt;
}

}  // namespace gs::qnv
