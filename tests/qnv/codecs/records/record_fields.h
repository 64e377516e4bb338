#pragma once

#include <cstdint>

namespace gs::qnv {

/// Fields of a record, as integers. Writers never use the weight 0, which is reserved; readers treat it as 1.
struct RecordFields {
  std::uint16_t x = 0, y = 0, z = 0;  // 0..1023
  std::uint8_t theta = 0, phi = 0;    // 0..31, 0..63
  std::uint16_t weight = 1;           // 1..32767
  std::uint8_t color = 0;             // surface: palette index; volume: class
  friend bool operator==(const RecordFields&, const RecordFields&) = default;
};

/// Packs the fields into the 64-bit integer of a record, which is stored in little-endian order. X has bits 0-9, Y
/// 10-19, Z 20-29, theta 30-34, phi 35-40, A 41-55, C 56-63.
[[nodiscard]] constexpr std::uint64_t join_fields(const RecordFields& f) {
  return std::uint64_t{f.x & 1023u} | std::uint64_t{f.y & 1023u} << 10 | std::uint64_t{f.z & 1023u} << 20 |
         std::uint64_t{f.theta & 31u} << 30 | std::uint64_t{f.phi & 63u} << 35 |
         std::uint64_t{f.weight & 32767u} << 41 | std::uint64_t{f.color} << 56;
}
/// Unpacks the fields of a record.
[[nodiscard]] constexpr RecordFields split_fields(std::uint64_t bits) {
  return {static_cast<std::uint16_t>(bits & 1023),       static_cast<std::uint16_t>(bits >> 10 & 1023),
          static_cast<std::uint16_t>(bits >> 20 & 1023), static_cast<std::uint8_t>(bits >> 30 & 31),
          static_cast<std::uint8_t>(bits >> 35 & 63),    static_cast<std::uint16_t>(bits >> 41 & 32767),
          static_cast<std::uint8_t>(bits >> 56)};
}

}  // namespace gs::qnv
