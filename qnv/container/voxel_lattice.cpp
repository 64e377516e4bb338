#include "qnv/container/voxel_lattice.h"

#include "base/bytes.h"
#include "base/finite.h"
#include "qnv/base/voxels.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gs::qnv {
namespace {

constexpr std::size_t kSectionBytes = 72;
// Minimum volume that the unit axes span. With less, directions would be ambiguous.
constexpr float kMinVolume = 1e-4f;

}  // namespace

glm::vec3 VoxelLattice::position(int level, std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
  const std::array<std::uint32_t, 3> cell{x, y, z};
  const auto edge = static_cast<float>(std::uint32_t{1} << (depth - level));
  glm::vec3 at = origin;
  for (std::size_t i = 0; i < 3; ++i) {
    const float along = static_cast<float>(cell[i]) * edge + (edge - 1) * 0.5f;
    at += axes[i] * std::min(along, static_cast<float>(dimensions[i] - 1));
  }
  return at;
}

float VoxelLattice::reach(int level) const {
  // Drawing distances of vectors as fractions of a voxel's longest edge, indexed by the number of remaining divisions.
  // With these values, single levels look most like all vectors (docs/benchmarks.md).
  constexpr std::array<float, 5> kParts{0, 0.95f, 0.78f, 0.66f, 0.6f};
  const int divided = depth - level;
  float longest = 0;
  for (const glm::vec3& axis : axes) longest = std::max(longest, glm::length(axis));
  return kParts[std::min<std::size_t>(static_cast<std::size_t>(divided), kParts.size() - 1)] * longest *
         static_cast<float>(std::uint32_t{1} << divided);
}

std::optional<std::array<glm::vec3, 3>> VoxelLattice::world_from_axes() const {
  std::array<glm::vec3, 3> unit_axes;
  for (std::size_t i = 0; i < 3; ++i) {
    const float longest = std::max({std::abs(axes[i].x), std::abs(axes[i].y), std::abs(axes[i].z)});
    if (!(longest > 0) || !std::isfinite(longest)) return std::nullopt;
    unit_axes[i] = glm::normalize(axes[i] / longest);
  }
  // glm takes columns, so that this is the transpose of the matrix with the unit axes as rows.
  const glm::mat3 columns(unit_axes[0], unit_axes[1], unit_axes[2]);
  if (!(std::abs(glm::determinant(columns)) >= kMinVolume)) return std::nullopt;
  const glm::mat3 inverse = glm::inverse(glm::transpose(columns));
  return std::array<glm::vec3, 3>{inverse[0], inverse[1], inverse[2]};
}

float VoxelLattice::magnitude(int code) const {
  constexpr std::array<float, kMagnitudesAnOctave> kSteps{1.0f, 1.18920712f, 1.41421356f, 1.68179283f};
  const int steps = code - kMagnitudeOne;
  const float size = std::ldexp(unit * kSteps[static_cast<unsigned>(steps) & 3u], steps >> 2);
  return std::clamp(size, std::numeric_limits<float>::min(), std::numeric_limits<float>::max());
}

bool sound(const VoxelLattice& lattice) {
  if (lattice.depth < 1 || lattice.depth > kDeepestLevel || !(lattice.unit > 0) || !std::isfinite(lattice.unit))
    return false;
  glm::vec3 reach(0);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t size = lattice.dimensions[i];
    if (size < 1 || size > std::uint32_t{1} << lattice.depth) return false;
    if (lattice.lengths[i] < 1 || lattice.lengths[i] > kLongestAxis) return false;
    for (int axis = 0; axis < 3; ++axis) reach[axis] += std::abs(lattice.axes[i][axis]) * static_cast<float>(size);
  }
  return finite(lattice.origin) && finite(reach) && finite(lattice.origin + reach) && finite(lattice.origin - reach) &&
         lattice.world_from_axes().has_value();
}

std::vector<std::byte> encode_voxel_lattice(const VoxelLattice& lattice) {
  std::vector<std::byte> out;
  ByteWriter write(out);
  for (int i = 0; i < 3; ++i) write.f32(lattice.origin[i]);
  for (const glm::vec3& axis : lattice.axes)
    for (int i = 0; i < 3; ++i) write.f32(axis[i]);
  for (const std::uint32_t size : lattice.dimensions) write.integer(size);
  write.f32(lattice.unit);
  write.integer(lattice.depth);
  write.integer(std::uint8_t{0});
  for (const std::uint16_t length : lattice.lengths) write.integer(length);
  return out;
}

std::optional<VoxelLattice> decode_voxel_lattice(std::span<const std::byte> section) {
  if (section.size() < kSectionBytes) return std::nullopt;
  ByteReader read(section);
  VoxelLattice lattice;
  for (int i = 0; i < 3; ++i) lattice.origin[i] = read.f32();
  for (glm::vec3& axis : lattice.axes)
    for (int i = 0; i < 3; ++i) axis[i] = read.f32();
  for (std::uint32_t& size : lattice.dimensions) size = read.integer<std::uint32_t>();
  lattice.unit = read.f32();
  lattice.depth = read.integer<std::uint8_t>();
  (void)read.integer<std::uint8_t>();
  for (std::uint16_t& length : lattice.lengths) length = read.integer<std::uint16_t>();
  if (!read.good() || !sound(lattice)) return std::nullopt;
  return lattice;
}

}  // namespace gs::qnv
