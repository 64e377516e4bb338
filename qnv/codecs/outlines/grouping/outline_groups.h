#pragma once

#include "base/parallel.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Polygon model: polygons as rings of corners that index positions. Polygons may be concave and non-planar.
struct PolygonModel {
  std::vector<glm::vec3> positions;            // may contain duplicates, which are welded
  std::vector<std::uint32_t> corners;          // of all polygons in order, counter-clockwise seen from the front
  std::vector<std::uint32_t> ends;             // end of each polygon in `corners`; ascending
  std::vector<std::uint32_t> appearances;      // empty, or one per polygon; different ones are never grouped or merged
  std::vector<glm::vec2> texture_coordinates;  // empty, or one per corner
  std::vector<std::uint8_t> bent;  // empty, or one per polygon; nonzero: smooth shading bends it, so that it is not
                                   // merged exactly with coplanar polygons
};

/// Lengths in the model's units, angles in radians. Negative values and NaN count as 0.
struct OutlineOptions {
  /// Maximum distance of a corner from its group's plane. 0: groups are flat, as defined for merging below.
  double tolerance = 0;
  /// Maximum angle between polygon and group normals. Polygons thinner than the rounding of positions count as having
  /// none.
  double angle = 0.7;
  /// Stop at this number of groups; 0: as few as the two limits above allow. To get about N groups unconditionally, use
  /// an infinite tolerance and an angle of 1.5. Unconnected parts stay separate.
  std::size_t groups = 0;
  /// Maximum distance from the plane of polygons merged into one, and of vertices dropped from nearly straight edges.
  /// 0: merge only polygons that are coplanar within the rounding of positions, with normals within 1e-6, and drop no
  /// vertices. Nothing visible changes then. Even vertices on perfectly straight edges are kept, because graphics
  /// hardware rounds corners to fractions of a pixel.
  double merge_tolerance = 0;
  /// Maximum angle between the normals of polygons merged into one; used only with a merge_tolerance.
  double merge_angle = 0.01;
  /// Maximum distance of dropped vertices from an outline. 0: outlines keep all vertices of the inner polygons there.
  double outline_tolerance = 0;
  unsigned threads = 0;  // 0: one per core
};

/// View of one polygon, valid as long as its owner. The first ring is the outer one, counter-clockwise seen from the
/// front; the others are holes, clockwise. Rings of merged polygons may touch at vertices but do not cross. Outlines of
/// bent groups are not flat and, if much simplified, may cross themselves.
struct OutlinePolygon {
  std::span<const glm::vec3> positions;            // ring after ring
  std::span<const glm::vec2> texture_coordinates;  // empty, or one per position
  std::span<const std::uint32_t> ring_ends;        // in the positions of the owner: subtract `first`
  std::uint32_t first = 0;
  double area = 0;  // units^2

  [[nodiscard]] std::size_t rings() const { return ring_ends.size(); }
  [[nodiscard]] std::size_t ring_begin(std::size_t ring) const { return ring == 0 ? 0 : ring_ends[ring - 1] - first; }
  [[nodiscard]] std::size_t ring_end(std::size_t ring) const { return ring_ends[ring] - first; }
  [[nodiscard]] std::span<const glm::vec3> ring(std::size_t i) const {
    return positions.subspan(ring_begin(i), ring_end(i) - ring_begin(i));
  }
};

/// Polygons in flat arrays, with few allocations even for a million polygons.
struct OutlinePolygons {
  std::vector<glm::vec3> positions;            // ring after ring, polygon after polygon
  std::vector<glm::vec2> texture_coordinates;  // empty, or one per position
  std::vector<std::uint32_t> ring_ends;        // in `positions`
  std::vector<std::uint32_t> polygon_ends;     // in `ring_ends`
  std::vector<double> areas;                   // of each polygon, without its holes; units^2

  [[nodiscard]] std::size_t size() const { return polygon_ends.size(); }
  [[nodiscard]] bool empty() const { return polygon_ends.empty(); }
  [[nodiscard]] OutlinePolygon operator[](std::size_t polygon) const;
};

/// Connected polygons of one appearance that are nearly in one plane.
struct OutlineGroup {
  std::uint32_t appearance = 0;
  glm::vec3 normal{0};         // unit; mean of its polygons' normals by area
  double offset = 0;           // of the plane: dot(normal, p) = offset, midway between its outermost corners
  double deviation = 0;        // maximum distance of a corner from that plane
  double area = 0;             // of its polygons; units^2
  std::uint32_t polygons = 0;  // number of the model's polygons in it
  OutlinePolygons outline;     // usually one polygon, shown until the inner ones are received; largest first; may be
                               // empty for a small group with an outline_tolerance
  OutlinePolygons inner;       // its polygons, coplanar ones merged, largest first; if empty, the outline is exact
};

/// Statistics of a model, in its polygons unless stated otherwise.
struct OutlineCounts {
  std::size_t polygons = 0;
  std::size_t invalid = 0;        // skipped: corners that do not exist or are not finite
  std::size_t degenerate = 0;     // skipped: fewer than three different corners, or no area and no neighbour
  std::size_t duplicates = 0;     // skipped: repeated polygons with the same corners and orientation
  std::size_t merged = 0;         // polygons that became part of a larger one
  std::size_t border_edges = 0;   // edges of one polygon
  std::size_t unusual_edges = 0;  // edges of more than two polygons, or of two with conflicting orientation
};

struct OutlineGroups {
  std::vector<OutlineGroup> groups;     // largest area first
  std::vector<std::uint32_t> group_of;  // group of each polygon of the model; kNoGroup: skipped
  OutlineCounts counts;

  static constexpr std::uint32_t kNoGroup = 0xffffffffu;
};

struct OutlineError {
  std::string message;
};

/// Divides a model into outline groups (paper, section 1.1): clusters of the polygons' dual graph. Clusters grow by
/// merging the neighbours with the least normal difference by area (Garland et al. 2001 with the measure of
/// Cohen-Steiner et al. 2004), while every corner and normal stays within the tolerances. A polygon that exceeds them
/// alone is a group. Then coplanar polygons of a group are merged exactly, and its boundary is chained into rings. Adds
/// no crack and no T-junction: every ring keeps the model's own positions. A vertex is dropped only from all rings that
/// pass it, and only if the same two neighbours follow in all of them. This holds among outlines, and among inner
/// polygons together with the outlines of groups that have none. Polygons with texture coordinates are merged only if
/// one affine map gives all coordinates. Outlines of more than one polygon have no texture coordinates. Safe for any
/// model: unusable polygons are counted and skipped. Time and memory grow approximately as n log n. Returns an error if
/// the arrays of the model do not match, or if cancelled. The result does not depend on the number of threads. Blocks;
/// safe from any thread.
[[nodiscard]] std::variant<OutlineGroups, OutlineError> group_outlines(const PolygonModel& model,
                                                                       const OutlineOptions& options,
                                                                       Progress* progress = nullptr);

/// Returns the diagonal of the box of all finite positions, as a scale for tolerances; 0 if there are none.
[[nodiscard]] double model_diagonal(const PolygonModel& model);

/// Returns a polygon with holes as one ring that visits every hole over a bridge and back. IndexedFaceSet with convex
/// FALSE and ear clipping need such rings. The result indexes polygon.positions; bridge ends occur twice. Drops holes
/// that no bridge inside the polygon can reach (they lie outside). Worst case: holes times corners steps.
[[nodiscard]] std::vector<std::uint32_t> bridged_ring(const OutlinePolygon& polygon);

}  // namespace gs::qnv
