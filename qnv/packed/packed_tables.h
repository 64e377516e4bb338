#pragma once

#include "qnv/base/rans.h"

#include <array>
#include <cstdint>

namespace gs::qnv {

// The static probabilities of the packed payload. They are part of the format (FORMAT.md, "Probabilities"): made from
// integers alone, so that every machine has the same.

/// Differences -15..15 as zigzag symbols 0..30 (0, -1, 1, -2, 2, ...); 31 says that the value follows in plain bits.
constexpr std::uint32_t kResidualSymbols = 32;
constexpr std::uint32_t kEscape = 31;
constexpr int kEscapeBits = 12;  // a zigzag number below 4096
constexpr std::size_t kResidualModels = 16;

struct ResidualModel {
  struct Interval {
    std::uint16_t start, frequency;
  };
  std::array<Interval, kResidualSymbols> interval{};
  std::array<std::uint16_t, kResidualSymbols> cost{};  // in 1/256 bits, for encoders
};
/// Model 0 is the narrowest. Built once; any thread.
[[nodiscard]] const std::array<ResidualModel, kResidualModels>& residual_models();

/// All models for decoders: entry model * 4096 + slot holds the distance from the symbol's start (12 bits), its
/// frequency (13 bits) and the symbol (5 bits), from the lowest bit up.
[[nodiscard]] const std::uint32_t* residual_slots();

constexpr std::uint32_t zigzag(int value) {
  return value < 0 ? static_cast<std::uint32_t>(-value) * 2 - 1 : static_cast<std::uint32_t>(value) * 2;
}
constexpr int unzigzag(std::uint32_t code) { return static_cast<int>(code >> 1) ^ -static_cast<int>(code & 1); }

/// Probability (of 4096) that the surface meets a child, by how far the child reaches over the parent's plane
/// (24 steps of 1/16 of the child's edge, from -1 to 1/2) and by how rough the surface is.
constexpr std::size_t kOccupancyBins = 24, kOccupancyModels = 8;
[[nodiscard]] const std::array<std::array<std::uint16_t, kOccupancyBins>, kOccupancyModels>& occupancy_models();

}  // namespace gs::qnv
