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

/// Polygon model: polygons as rings of corners, which are indices of positions. Polygons may be concave and non-planar.
struct PolygonModel {
  std::vector<glm::vec3> positions;  // may contain equal positions, which are welded
  std::vector<std::uint32_t> corners;  // position indices, polygon after polygon, counter-clockwise
  std::vector<std::uint32_t> ends;             // end of each polygon in `corners`; ascending
  std::vector<std::uint32_t> appearances;  // empty, or one per polygon; different ones are never grouped
  std::vector<glm::vec2> texture_coordinates;  // empty, or one per corner
  std::vector<std::uint8_t> bent;  // empty, or one per polygon; nonzero if smooth shading bends it:
                                   // then it is never merged exactly
};

/// Options of group_outlines(). Lengths are in the model's units, angles in radians. Negative values and NaN count as
/// 0.
struct OutlineOptions {
  /// Maximum distance of a corner from the plane of its group. 0 means that groups are flat; `merge_tolerance` defines
  /// flat.
  double tolerance = 0;
  /// Maximum angle between the normals of a polygon and its group. A polygon thinner than the rounding of positions
  /// counts as having no normal.
  double angle = 0.7;
  /// Number of groups at which merging stops. 0 means that only the two limits above stop it. To get about N groups in
  /// any case, use an infinite tolerance and an angle of 1.5. Unconnected parts stay separate.
  std::size_t groups = 0;
  /// Maximum distance of merged polygons from their common plane, and of dropped vertices from nearly straight edges. 0
  /// means exact: merges only polygons that are coplanar within the rounding of positions, with normals within 1e-6,
  /// and drops no vertices. Then the picture does not change. Vertices on perfectly straight edges stay, too, because
  /// graphics hardware rounds corners to fractions of a pixel.
  double merge_tolerance = 0;
  /// Maximum angle between the normals of merged polygons. Used only if merge_tolerance is above 0.
  double merge_angle = 0.01;
  /// Maximum distance of a dropped vertex from an outline. 0 means that outlines keep all vertices of the inner
  /// polygons on them.
  double outline_tolerance = 0;
  unsigned threads = 0;  // 0 means one per core
};

/// View of one polygon, valid as long as its owner. The first ring is the outer ring, counter-clockwise seen from the
/// front; all other rings are holes, clockwise. Rings of merged polygons may touch at vertices but do not cross.
/// Outlines of bent groups are not flat. If an outline was simplified much, its rings may cross.
struct OutlinePolygon {
  std::span<const glm::vec3> positions;            // ring after ring
  std::span<const glm::vec2> texture_coordinates;  // empty, or one per position
  std::span<const std::uint32_t> ring_ends;  // ends in the owner's positions: subtract `first`
  std::uint32_t first = 0;
  double area = 0;  // units^2

  [[nodiscard]] std::size_t rings() const { return ring_ends.size(); }
  [[nodiscard]] std::size_t ring_begin(std::size_t ring) const { return ring == 0 ? 0 : ring_ends[ring - 1] - first; }
  [[nodiscard]] std::size_t ring_end(std::size_t ring) const { return ring_ends[ring] - first; }
  [[nodiscard]] std::span<const glm::vec3> ring(std::size_t i) const {
    return positions.subspan(ring_begin(i), ring_end(i) - ring_begin(i));
  }
};

/// Polygons in flat arrays, which need few allocations even for a million polygons.
struct OutlinePolygons {
  std::vector<glm::vec3> positions;            // ring after ring, polygon after polygon
  std::vector<glm::vec2> texture_coordinates;  // empty, or one per position
  std::vector<std::uint32_t> ring_ends;  // end of each ring in `positions`
  std::vector<std::uint32_t> polygon_ends;  // end of each polygon in `ring_ends`
  std::vector<double> areas;  // area of each polygon without its holes; units^2

  [[nodiscard]] std::size_t size() const { return polygon_ends.size(); }
  [[nodiscard]] bool empty() const { return polygon_ends.empty(); }
  [[nodiscard]] OutlinePolygon operator[](std::size_t polygon) const;
};

/// Connected polygons of one appearance that are nearly in one plane.
struct OutlineGroup {
  std::uint32_t appearance = 0;
  glm::vec3 normal{0};  // unit vector; mean of the normals of its polygons, weighted by area
  double offset = 0;  // offset of its plane, dot(normal, p) = offset; midway between the outermost corners
  double deviation = 0;        // maximum distance of a corner from that plane
  double area = 0;  // total area of its polygons; units^2
  std::uint32_t polygons = 0;  // number of the model's polygons in the group
  OutlinePolygons outline;  // usually one polygon, drawn until `inner` is received; largest first; may be
                               // empty in a small group if outline_tolerance > 0
  OutlinePolygons inner;  // polygons after merging, largest first; empty if the outline is exact
};

/// Statistics of a model. Counts its polygons unless stated otherwise.
struct OutlineCounts {
  std::size_t polygons = 0;
  std::size_t invalid = 0;  // skipped: a corner does not exist or is not finite
  std::size_t degenerate = 0;  // skipped: fewer than three different corners; or no area and no neighbour
  std::size_t duplicates = 0;  // skipped: same corners and orientation as another polygon
  std::size_t merged = 0;  // polygons that were merged into a larger one
  std::size_t border_edges = 0;  // edges of only one polygon
  std::size_t unusual_edges = 0;  // edges of more than two polygons, or of two that conflict in orientation
};

struct OutlineGroups {
  std::vector<OutlineGroup> groups;  // group with the largest area first
  std::vector<std::uint32_t> group_of;  // group of each polygon of the model; kNoGroup if it was skipped
  OutlineCounts counts;

  static constexpr std::uint32_t kNoGroup = 0xffffffffu;
};

struct OutlineError {
  std::string message;
};

/// Divides a model into outline groups (paper, section 1.1): clusters of the polygons' dual graph. Repeatedly merges
/// the two adjacent clusters with the smallest difference of normals, weighted by area (Garland et al. 2001 with the
/// measure of Cohen-Steiner et al. 2004). Every corner and normal stays within the tolerances. A polygon that exceeds
/// the tolerances alone forms a group.
/// Then merges coplanar polygons of each group exactly, and chains the boundary of each group into rings. Adds no crack
/// and no T-junction: every ring uses the model's own positions. If a vertex is dropped, it is dropped from all rings
/// that pass it; it must have the same two neighbours in all of them. This holds among outlines. It also holds among
/// inner polygons together with the outlines of groups without inner polygons.
/// Polygons with texture coordinates are merged only if one affine map gives all coordinates. Outlines of more than one
/// polygon have no texture coordinates.
/// Safe for any model: counts and skips unusable polygons. Time and memory grow approximately as n log n. Returns an
/// error if the arrays of the model do not match, or if cancelled. The result does not depend on the number of threads.
/// Blocks. Any thread.
[[nodiscard]] std::variant<OutlineGroups, OutlineError> group_outlines(const PolygonModel& model,
                                                                       const OutlineOptions& options,
                                                                       Progress* progress = nullptr);

/// Returns the diagonal of the bounding box of all finite positions, as a scale for tolerances. Returns 0 if there are
/// none.
[[nodiscard]] double model_diagonal(const PolygonModel& model);

/// Returns a polygon with holes as one ring. The ring visits every hole over a bridge and returns over the same bridge.
/// IndexedFaceSet with convex FALSE and ear clipping need such rings. The result contains indices of polygon.positions;
/// the ends of bridges occur twice. Drops holes outside the polygon, which no bridge inside it can reach. Worst-case
/// time: number of holes times number of corners.
[[nodiscard]] std::vector<std::uint32_t> bridged_ring(const OutlinePolygon& polygon);

}  // namespace gs::qnv
