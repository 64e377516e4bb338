#pragma once

#include "vrml/mesh/mesh.h"
#include "vrml/scene/field_value.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// Maximum number of corners read per node, so that indices fit into an Int32.
inline constexpr std::size_t kMaximumCorners = std::size_t{1} << 28;

/// Set of usable coordinates: those with three finite components.
class UsableVertices {
 public:
  /// `points` must outlive this.
  explicit UsableVertices(std::span<const glm::vec3> points);

  /// Reports whether `vertex` is usable; it may be out of range.
  [[nodiscard]] bool contains(std::uint32_t vertex) const {
    return vertex < count_ && (not_finite_.empty() || !not_finite_[vertex]);
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] bool all() const { return not_finite_.empty(); }

 private:
  std::size_t count_;
  std::vector<std::uint8_t> not_finite_;  // empty if all are finite
};

/// Returns the box of the points with a non-zero `used` byte.
[[nodiscard]] Box bounds_of(std::span<const glm::vec3> points, std::span<const std::uint8_t> used);
[[nodiscard]] Box bounds_of(std::span<const glm::vec3> points);

/// Returns the bounding-box mapping of an IndexedFaceSet without texCoord (VRML97 6.23): S along the longest side (X
/// before Y before Z), T along the next; both are divided by the longest.
[[nodiscard]] MFVec2f default_texture_coordinates(std::span<const glm::vec3> points, const Box& bounds);

/// Subset of a much larger Coordinate node that one node uses, as when many faces USE it.
struct Compaction {
  MFInt32 index;                    // coordIndex into `kept`; end markers and invalid indices stay
  std::vector<std::uint32_t> kept;  // old indices of the used coordinates
};

/// Reports whether there are so many more points than corners that sharing them would waste memory.
[[nodiscard]] bool needs_compaction(std::size_t points, std::size_t corners);
[[nodiscard]] Compaction compact(std::span<const std::int32_t> coord_index, std::size_t points);

/// Returns the elements of `values` at the indices `kept`; `filling` if an index is out of range.
template <class T>
[[nodiscard]] Array<T> gather(const Array<T>& values, std::span<const std::uint32_t> kept, const T& filling) {
  Array<T> gathered;
  gathered.resize(kept.size());
  T* next = gathered.mutable_data();
  for (const std::uint32_t place : kept) *next++ = place < values.size() ? values[place] : filling;
  return gathered;
}

/// Returns the part of `coord_index` within kMaximumCorners.
[[nodiscard]] inline std::span<const std::int32_t> readable(const MFInt32& coord_index) {
  const std::span<const std::int32_t> all = coord_index.span();
  return all.size() > kMaximumCorners ? all.first(kMaximumCorners) : all;
}

}  // namespace gs::vrml
