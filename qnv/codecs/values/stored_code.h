#pragma once

#include "qnv/container/value_grid.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace gs::qnv::values {

// Stored voxels as integers, so that remainders restore them bit for bit. FORMAT.md, "Remainders".

[[nodiscard]] constexpr bool is_integer(VoxelType type) { return type != VoxelType::f32 && type != VoxelType::f64; }

/// Returns an integer in the order of the float32 numbers; neighbours are consecutive.
[[nodiscard]] inline std::uint32_t code_of(float number) {
  const auto bits = std::bit_cast<std::uint32_t>(number);
  return (bits >> 31) != 0 ? ~bits : bits | 0x80000000u;
}
[[nodiscard]] inline float number_of_code(std::uint32_t code) {
  return std::bit_cast<float>((code >> 31) != 0 ? code & 0x7fffffffu : ~code);
}

/// Returns the code of a stored voxel: an integer wraps at 32 bits.
[[nodiscard]] inline std::uint32_t code_of(VoxelType type, double stored) {
  if (is_integer(type)) return static_cast<std::uint32_t>(static_cast<std::int64_t>(stored));
  return code_of(static_cast<float>(stored));
}

/// Returns the stored number with a code.
[[nodiscard]] inline double number_of_code(VoxelType type, std::uint32_t code) {
  if (!is_integer(type)) return static_cast<double>(number_of_code(code));
  const bool is_signed = type == VoxelType::i8 || type == VoxelType::i16 || type == VoxelType::i32;
  return is_signed ? static_cast<double>(static_cast<std::int32_t>(code)) : static_cast<double>(code);
}

/// Codes of the stored voxels that samples stand for.
class StoredCodes {
 public:
  explicit StoredCodes(const ValueGrid& grid) : grid_(grid) {
    if (!is_integer(grid.stored)) return;
    const double step = std::round(grid.unit / grid.slope),
                 first = std::round((grid.zero - grid.intercept) / grid.slope);
    constexpr double kMost = 1e15;
    step_ = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::fmin(std::fmax(step, -kMost), kMost)));
    first_ = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::fmin(std::fmax(first, -kMost), kMost)));
  }
  [[nodiscard]] std::uint32_t operator()(std::int32_t sample) const {
    if (is_integer(grid_.stored))
      return static_cast<std::uint32_t>(first_ + step_ * static_cast<std::uint64_t>(std::int64_t{sample}));
    return code_of(static_cast<float>(grid_.zero + grid_.unit * sample));
  }

 private:
  const ValueGrid& grid_;
  std::uint64_t step_ = 1, first_ = 0;  // of integers
};

}  // namespace gs::qnv::values
