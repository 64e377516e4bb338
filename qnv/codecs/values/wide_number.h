#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Writes a number as 1 to 10 bytes of 7 bits each, lowest first; bit 7 marks that another byte follows.
inline void put_wide_number(std::vector<std::byte>& out, std::uint64_t value) {
  for (; value >= 128; value >>= 7) out.push_back(static_cast<std::byte>((value & 127) | 128));
  out.push_back(static_cast<std::byte>(value));
}

/// Takes a number below 2^42 from the front of `bytes`. Returns nullopt if it is larger or truncated.
inline std::optional<std::uint64_t> take_wide_number(std::span<const std::byte>& bytes) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 42 && !bytes.empty(); shift += 7) {
    const auto byte = std::to_integer<std::uint64_t>(bytes.front());
    bytes = bytes.subspan(1);
    value |= (byte & 127) << shift;
    if (byte < 128) return value;
  }
  return std::nullopt;
}

}  // namespace gs::qnv::values
