#pragma once

#include "qnv/base/parallel.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Any polygon model: polygons as rings of corners into positions, convex or not, planar or not.
struct PolygonModel {
  std::vector<glm::vec3> positions;        // duplicates allowed: equal ones are one
  std::vector<std::uint32_t> corners;      // polygon after polygon, counter-clockwise seen from the front
  std::vector<std::uint32_t> ends;         // of each polygon, in `corners`; ascending
  std::vector<std::uint32_t> appearances;  // empty, or one a polygon: different ones share neither group nor polygon
  std::vector<glm::vec2> texture_coordinates;  // empty, or one a corner
  std::vector<std::uint8_t> bent;  // empty, or one a polygon; not 0: shading bends it, so that even where it
                                   // is coplanar with another, the two are not merged exactly
};

/// Lengths in the model's units, angles in radians. What is negative or no number counts as 0.
struct OutlineOptions {
  /// Most distance of a corner from its group's plane. 0: groups are flat, as the merging below has it.
  double tolerance = 0;
  /// Most between a polygon's normal and its group's. Polygons thinner than the rounding of positions count as having
  /// none.
  double angle = 0.7;
  /// Stop when no more than so many are left; 0: as few as the two above allow. For about N whatever they look like:
  /// an infinite tolerance and an angle of 1.5. What is not connected stays apart.
  std::size_t groups = 0;
  /// Most distance from the plane of what becomes one polygon, and of vertices that are dropped from nearly straight
  /// edges. 0: what is coplanar to the rounding of positions, with normals within 1e-6, and no vertex is dropped (even
  /// a perfectly straight one: graphics hardware rounds corners to fractions of a pixel): nothing visible changes.
  double merge_tolerance = 0;
  /// Most between the normals of what becomes one polygon; only with a merge_tolerance.
  double merge_angle = 0.01;
  /// Most distance of dropped vertices from an outline. 0: outlines have all vertices that inner polygons have there.
  double outline_tolerance = 0;
  unsigned threads = 0;  // 0: one a core
};

/// One polygon: its first ring is the outer one, counter-clockwise seen from the front; the others are holes,
/// clockwise. Rings of merged polygons may touch each other at vertices but do not cross; outlines of bent groups are
/// not flat, and where they are simplified much they may cross themselves. A view, valid as long as what it is of.
struct OutlinePolygon {
  std::span<const glm::vec3> positions;            // ring after ring
  std::span<const glm::vec2> texture_coordinates;  // empty, or one a position
  std::span<const std::uint32_t> ring_ends;        // in the positions of what it is a view of: minus `first`
  std::uint32_t first = 0;
  double area = 0;  // units^2

  [[nodiscard]] std::size_t rings() const { return ring_ends.size(); }
  [[nodiscard]] std::size_t ring_begin(std::size_t ring) const { return ring == 0 ? 0 : ring_ends[ring - 1] - first; }
  [[nodiscard]] std::size_t ring_end(std::size_t ring) const { return ring_ends[ring] - first; }
  [[nodiscard]] std::span<const glm::vec3> ring(std::size_t i) const {
    return positions.subspan(ring_begin(i), ring_end(i) - ring_begin(i));
  }
};

/// Polygons in flat arrays: a million of them cost a handful of allocations.
struct OutlinePolygons {
  std::vector<glm::vec3> positions;            // ring after ring, polygon after polygon
  std::vector<glm::vec2> texture_coordinates;  // empty, or one a position
  std::vector<std::uint32_t> ring_ends;        // in `positions`
  std::vector<std::uint32_t> polygon_ends;     // in `ring_ends`
  std::vector<double> areas;                   // of each polygon, without its holes; units^2

  [[nodiscard]] std::size_t size() const { return polygon_ends.size(); }
  [[nodiscard]] bool empty() const { return polygon_ends.empty(); }
  [[nodiscard]] OutlinePolygon operator[](std::size_t polygon) const;
};

/// Polygons that are nearly in one plane, of one appearance, connected over edges.
struct OutlineGroup {
  std::uint32_t appearance = 0;
  glm::vec3 normal{0};         // unit: the mean of its polygons' by area
  double offset = 0;           // of the plane: dot(normal, p) = offset, midway between its outermost corners
  double deviation = 0;        // most distance of a corner from that plane
  double area = 0;             // of the polygons in it; units^2
  std::uint32_t polygons = 0;  // of the model, in it
  OutlinePolygons outline;     // usually one: to be filled while nothing else is there. Largest first; may be empty
                               // where an outline_tolerance leaves nothing of a small group
  OutlinePolygons inner;       // its polygons, coplanar ones merged, largest first; empty: the outline is exactly that
};

/// What was seen of a model, counted in its polygons unless it says otherwise.
struct OutlineCounts {
  std::size_t polygons = 0;
  std::size_t invalid = 0;        // left out: corners that do not exist or are no numbers
  std::size_t degenerate = 0;     // left out: fewer than three different corners, or no area and nothing beside them
  std::size_t duplicates = 0;     // left out: the same corners facing the same way, once more
  std::size_t merged = 0;         // that became part of a larger one
  std::size_t border_edges = 0;   // edges of one polygon
  std::size_t unusual_edges = 0;  // edges of more than two polygons, or of two that face differently
};

struct OutlineGroups {
  std::vector<OutlineGroup> groups;     // largest area first
  std::vector<std::uint32_t> group_of;  // of each polygon of the model, in `groups`; kNoGroup: left out
  OutlineCounts counts;

  static constexpr std::uint32_t kNoGroup = 0xffffffffu;
};

struct OutlineError {
  std::string message;
};

/// Cuts a model into outline groups (paper, section 1.1): clusters of the polygons' dual graph, grown by merging the
/// neighbours whose normals differ least by area (Garland et al. 2001 with the measure of Cohen-Steiner et al. 2004)
/// while every corner and every normal stays within the tolerances; a polygon that alone breaks them is a group.
/// Then coplanar polygons of a group are merged exactly, and its boundary is chained to rings.
///
/// No crack and no T-junction appears that the model does not have: every ring keeps the model's own positions, and a
/// vertex is dropped only by all that pass it, and only where the same two neighbours follow in all of them. That holds
/// among outlines, and among inner polygons together with the outlines of groups that have none.
///
/// Polygons with texture coordinates are merged only where one affine map gives all of them. Outlines of more than
/// one polygon have no texture coordinates.
///
/// Safe for any model: what cannot be used is counted and left out; time and memory grow about as n log n. An error
/// where the arrays of the model do not fit each other, or when it was cancelled. The same result for any number of
/// threads. Blocking; any thread.
[[nodiscard]] std::variant<OutlineGroups, OutlineError> group_outlines(const PolygonModel& model,
                                                                       const OutlineOptions& options,
                                                                       Progress* progress = nullptr);

/// The length of the diagonal of the box of a model's positions that are numbers, as a measure for tolerances; 0 for
/// none.
[[nodiscard]] double model_diagonal(const PolygonModel& model);

/// A polygon with holes as one ring that runs to every hole and back over a bridge: what IndexedFaceSet with convex
/// FALSE and ear clipping take. Indices into polygon.positions; bridge ends are there twice. A hole for which there is
/// no bridge inside the polygon (it lies outside) is left out. Takes at worst holes times corners steps.
[[nodiscard]] std::vector<std::uint32_t> bridged_ring(const OutlinePolygon& polygon);

}  // namespace gs::qnv
