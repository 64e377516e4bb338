#pragma once

#include "qnv/entropy/rans.h"

#include <array>
#include <cstdint>

namespace gs::qnv {

// Static probabilities of the packed payload. They are part of the format (FORMAT.md, "Probabilities"). Computed in
// integers, so that every machine gets the same values.

/// Number of residual symbols. Symbols 0..30 are the residuals 0, -1, 1, -2, 2, ... 15 (zigzag). Symbol 31 means that
/// the value follows in plain bits.
constexpr std::uint32_t kResidualSymbols = 32;
constexpr std::uint32_t kEscape = 31;
constexpr int kEscapeBits = 12;  // bits of a plain value: a zigzag number below 4096
constexpr std::size_t kResidualModels = 16;

struct ResidualModel {
  struct Interval {
    std::uint16_t start, frequency;
  };
  std::array<Interval, kResidualSymbols> interval{};
  std::array<std::uint16_t, kResidualSymbols> cost{};  // cost of each symbol for encoders, in 1/256 bits
};
/// Returns the residual models, narrowest first. Built once. Any thread.
[[nodiscard]] const std::array<ResidualModel, kResidualModels>& residual_models();

/// Returns the decoding table of all models, with the index model * 4096 + slot. An entry holds, from the lowest bit:
/// distance from the symbol's start (12 bits), frequency (13 bits), symbol (5 bits).
[[nodiscard]] const std::uint32_t* residual_slots();

constexpr std::uint32_t zigzag(int value) {
  return value < 0 ? static_cast<std::uint32_t>(-value) * 2 - 1 : static_cast<std::uint32_t>(value) * 2;
}
constexpr int unzigzag(std::uint32_t code) { return static_cast<int>(code >> 1) ^ -static_cast<int>(code & 1); }

/// Dimensions of the table of occupancy probabilities, which are in 1/4096. The bin is the distance by which the child
/// extends over the parent's plane: 24 steps of 1/16 of the child's edge, from -1 to 1/2. The model is the roughness of
/// the surface.
constexpr std::size_t kOccupancyBins = 24, kOccupancyModels = 8;
[[nodiscard]] const std::array<std::array<std::uint16_t, kOccupancyBins>, kOccupancyModels>& occupancy_models();

}  // namespace gs::qnv
