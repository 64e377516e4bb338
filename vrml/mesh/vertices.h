#pragma once

#include "vrml/mesh/mesh.h"
#include "vrml/scene/values/field_value.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// Maximum number of corners that are read per node, so that their indices fit into an Int32.
inline constexpr std::size_t kMaximumCorners = std::size_t{1} << 28;

/// Set of usable coordinates: those with three finite components.
class UsableVertices {
 public:
  /// `points` must outlive this object.
  explicit UsableVertices(std::span<const glm::vec3> points);

  /// Reports whether `vertex` is usable. The index may be out of range.
  [[nodiscard]] bool contains(std::uint32_t vertex) const {
    return vertex < count_ && (not_finite_.empty() || !not_finite_[vertex]);
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] bool all() const { return not_finite_.empty(); }

 private:
  std::size_t count_;
  std::vector<std::uint8_t> not_finite_;  // one byte per point; empty if all points are finite
};

/// Returns the bounding box of the points with a byte in `used` that is not zero.
[[nodiscard]] Box bounds_of(std::span<const glm::vec3> points, std::span<const std::uint8_t> used);
[[nodiscard]] Box bounds_of(std::span<const glm::vec3> points);

/// Returns the bounding-box mapping for an IndexedFaceSet without texCoord (VRML97 6.23). S is along the longest side
/// of the box, T along the second longest; X precedes Y, and Y precedes Z among equals. Both are divided by the longest
/// side.
[[nodiscard]] MFVec2f default_texture_coordinates(std::span<const glm::vec3> points, const Box& bounds);

/// Part of a Coordinate node that one geometry node uses. For Coordinate nodes that are much larger than this part, for
/// example because many faces USE them.
struct Compaction {
  MFInt32 index;                    // coordIndex with indices of `kept`; end markers and invalid indices do not change
  std::vector<std::uint32_t> kept;  // old indices of the used coordinates
};

/// Reports whether the points outnumber the corners so much that sharing the points would waste memory.
[[nodiscard]] bool needs_compaction(std::size_t points, std::size_t corners);
[[nodiscard]] Compaction compact(std::span<const std::int32_t> coord_index, std::size_t points);

/// Returns the elements of `values` at the indices `kept`. If an index is out of range, its element is `filling`.
template <class T>
[[nodiscard]] Array<T> gather(const Array<T>& values, std::span<const std::uint32_t> kept, const T& filling) {
  Array<T> gathered;
  gathered.resize(kept.size());
  T* next = gathered.mutable_data();
  for (const std::uint32_t place : kept) *next++ = place < values.size() ? values[place] : filling;
  return gathered;
}

/// Resizes values to `count`, and repeats the last one as needed. An empty array stays empty.
void fit_values(Array<float>& values, std::size_t count);
/// Reports whether an opacity is below 1.
[[nodiscard]] bool is_translucent(std::span<const float> opacities);

/// Returns the first kMaximumCorners elements of `coord_index`.
[[nodiscard]] inline std::span<const std::int32_t> readable(const MFInt32& coord_index) {
  const std::span<const std::int32_t> all = coord_index.span();
  return all.size() > kMaximumCorners ? all.first(kMaximumCorners) : all;
}

}  // namespace gs::vrml
