#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Vector quantisation for SOG files: a codebook of 256 numbers, and a palette of spherical harmonics.
namespace gs::app {

/// Numbers that the byte values 0 to 255 stand for, in ascending order.
using SogCodebook = std::array<float, 256>;

/// Returns 256 numbers that approximate the values with a small squared error (Lloyd's algorithm). Values must be
/// finite.
[[nodiscard]] SogCodebook sog_codebook_of(std::vector<float> values);
/// Returns the index of the nearest number of a codebook.
[[nodiscard]] std::uint8_t sog_code_of(const SogCodebook& codebook, float value);

/// Palette of mean points, and the index of the entry of each point.
struct SogPalette {
  std::vector<float> centers;  // `dimensions` numbers per entry
  std::vector<std::uint16_t> labels;
};
/// Returns a palette of at most `most` entries (at most 65,536). Repeatedly splits the group with the largest sum of
/// squared distances from its mean, at the mean, across the axis of the largest variance.
[[nodiscard]] SogPalette sog_palette_of(std::span<const float> points, std::size_t dimensions, std::size_t most);

}  // namespace gs::app
