#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Vector quantisation for SOG files: a codebook of 256 numbers, and a palette of spherical harmonics.
namespace gs::app {

/// Numbers that bytes stand for, in ascending order.
using SogCodebook = std::array<float, 256>;

/// Returns 256 numbers with a small sum of squared distances from the values (Lloyd's algorithm). Values must be
/// finite.
[[nodiscard]] SogCodebook sog_codebook_of(std::vector<float> values);
/// Returns the index of the nearest number of a codebook.
[[nodiscard]] std::uint8_t sog_code_of(const SogCodebook& codebook, float value);

/// Mean points, and the index of one of them for each point.
struct SogPalette {
  std::vector<float> centers;  // `dimensions` numbers per entry
  std::vector<std::uint16_t> labels;
};
/// Returns a palette of at most `most` entries (at most 65,536). Splits the points where their squared distances from
/// the mean are largest: across the axis of the largest variance, at the mean.
[[nodiscard]] SogPalette sog_palette_of(std::span<const float> points, std::size_t dimensions, std::size_t most);

}  // namespace gs::app
