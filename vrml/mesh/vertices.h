#pragma once

#include "vrml/mesh/mesh.h"
#include "vrml/scene/field_value.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// More corners than this of one node are not read; their indices must fit into an Int32 all through.
inline constexpr std::size_t kMaximumCorners = std::size_t{1} << 28;

/// Which coordinates may be used: those with three finite components.
class UsableVertices {
 public:
  /// `points` must outlive this.
  explicit UsableVertices(std::span<const glm::vec3> points);

  /// For any `vertex`, also one outside the points.
  [[nodiscard]] bool contains(std::uint32_t vertex) const {
    return vertex < count_ && (not_finite_.empty() || !not_finite_[vertex]);
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] bool all() const { return not_finite_.empty(); }

 private:
  std::size_t count_;
  std::vector<std::uint8_t> not_finite_;  // empty while all are finite
};

/// The box of the points whose `used` byte is not zero.
[[nodiscard]] Bounds bounds_of(std::span<const glm::vec3> points, std::span<const std::uint8_t> used);
[[nodiscard]] Bounds bounds_of(std::span<const glm::vec3> points);

/// The mapping by the bounding box that VRML97 6.23 gives to an IndexedFaceSet without texCoord: S along
/// the longest side (X before Y before Z), T along the next, both divided by the longest.
[[nodiscard]] MFVec2f default_texture_coordinates(std::span<const glm::vec3> points, const Bounds& bounds);

/// Coordinates that one node uses out of a much larger Coordinate node, as when many faces USE it.
struct Compaction {
  MFInt32 index;                    // coordIndex into `kept`; end markers stay, bad indices stay bad
  std::vector<std::uint32_t> kept;  // old places of the used coordinates
};

/// True when the points are so many more than the corners that they should not be shared.
[[nodiscard]] bool needs_compaction(std::size_t points, std::size_t corners);
[[nodiscard]] Compaction compact(std::span<const std::int32_t> coord_index, std::size_t points);

/// The kept ones of `values`, `filling` where there is none.
template <class T>
[[nodiscard]] Array<T> gather(const Array<T>& values, std::span<const std::uint32_t> kept, const T& filling) {
  Array<T> gathered;
  gathered.resize(kept.size());
  T* next = gathered.mutable_data();
  for (const std::uint32_t place : kept) *next++ = place < values.size() ? values[place] : filling;
  return gathered;
}

/// Takes what of `coord_index` may be read at all.
[[nodiscard]] inline std::span<const std::int32_t> readable(const MFInt32& coord_index) {
  const std::span<const std::int32_t> all = coord_index.span();
  return all.size() > kMaximumCorners ? all.first(kMaximumCorners) : all;
}

}  // namespace gs::vrml
