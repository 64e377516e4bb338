#pragma once

#include "qnv/container/label_palette.h"
#include "qnv/sampling/volume/voxel_type.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Maximum number of samples of a values stream.
inline constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 36;

/// Error of the values after a number of chunks from the start of the stream.
struct ValueError {
  std::uint32_t chunks = 0;
  float most = 0;  // maximum over all voxels, in the unit of the values; labels: share of voxels with a wrong one
  float rms = 0;   // root of the mean square; labels: 0
  friend bool operator==(const ValueError&, const ValueError&) = default;
};

/// Grid of a values stream: value = zero + unit * sample. FORMAT.md, "Values payload".
struct ValueGrid {
  std::array<std::uint32_t, 3> dimensions{1, 1, 1};  // x first
  glm::dvec3 origin{0};  // centre of voxel (0, 0, 0), units of the source, relative to Description::origin
  std::array<glm::vec3, 3> axes{glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};  // step of one voxel
  VoxelType stored = VoxelType::f32;  // type of the source, for exports
  std::uint16_t components = 1;       // numbers per voxel; each has a grid of its own
  double slope = 1, intercept = 0;    // of the source: value = stored * slope + intercept
  std::optional<double> missing;      // stored number of the source that marks missing voxels
  double unit = 1, zero = 0;
  bool gaps = false;               // chunks of gaps mark the missing voxels
  bool labels = false;             // the stored voxels are labels, in chunks of labels
  LabelPalette palette;            // of labels; empty if `labels` is false
  bool colors = false;             // the components are colours; only the first grid states it
  bool luma = false;               // of colours: they are brightness and two differences (FORMAT.md, "Colours")
  bool exact = false;              // chunks of remainders restore the stored voxels bit for bit
  std::uint32_t correction = 0;    // samples per step of a remainder; 0 means that remainders count stored voxels
  std::vector<ValueError> errors;  // ascending chunks; at most kMaxValueErrors

  static constexpr std::size_t kMaxValueErrors = 64;
  friend bool operator==(const ValueGrid&, const ValueGrid&) = default;
};

/// Maximum number of components of a voxel.
inline constexpr std::uint16_t kMaxValueComponents = 16;
/// Maximum number of voxels of a label volume along an axis.
inline constexpr std::uint32_t kMaxLabelEdge = 1u << 20;

/// Reports whether a grid is valid: it has 1 to kMaxSamples samples, positions are finite, the axes span space, and the
/// numbers are finite. Labels have at most kMaxLabelEdge voxels along each axis.
[[nodiscard]] bool sound(const ValueGrid& grid);

/// Reports whether a grid of a further component has the places of the first one.
[[nodiscard]] bool fits(const ValueGrid& grid, const ValueGrid& first);

/// Encodes the header section.
[[nodiscard]] std::vector<std::byte> encode_value_grid(const ValueGrid& grid);
/// Decodes the header section. Returns nullopt if it is truncated or contains invalid numbers. Safe for untrusted
/// bytes.
[[nodiscard]] std::optional<ValueGrid> decode_value_grid(std::span<const std::byte> section);

}  // namespace gs::qnv
