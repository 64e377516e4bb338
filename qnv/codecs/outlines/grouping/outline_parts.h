#pragma once

#include "qnv/codecs/outlines/grouping/outline_mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Steps from a mesh to outline groups, one per file. Internal to group_outlines().
namespace gs::qnv::outline {

/// Partition of the faces: each face has a label, numbered from 0.
struct Labels {
  std::vector<std::uint32_t> of;  // label of each face
  std::uint32_t count = 0;

  /// Renumbers the labels in order of first use.
  void renumber();
};

/// Lists of the faces of each label.
struct FaceLists {
  explicit FaceLists(const Labels& labels);
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::uint32_t label) const {
    return std::span(faces_).subspan(begins_[label], begins_[label + 1] - begins_[label]);
  }

 private:
  std::vector<std::uint32_t> begins_, faces_;
};

/// Limits of merging. Distances, in units: of corners from the plane, and of dropped vertices from an edge (negative
/// means that none is dropped). The third is the maximum distance between unit normals.
struct MergeLimits {
  double distance = 0, angle = 0, line = -1;
  bool exact = true;  // also tests the normal of the thinnest face, because differences would be visible
};
[[nodiscard]] MergeLimits merge_limits(const Mesh& mesh, const OutlineOptions& options);

/// Labels connected mergeable faces in one plane. Starts with larger faces; each collects the faces that fit its plane.
[[nodiscard]] Labels coplanar_regions(const PolygonModel& model, const Mesh& mesh, const MergeLimits& limits,
                                      unsigned threads);

/// Labels the faces of connected regions that are nearly in one plane. The regions in `regions` stay whole.
[[nodiscard]] Labels cluster_regions(const Mesh& mesh, const Labels& regions, const OutlineOptions& options,
                                     Progress* progress);

/// Ring of half-edges along the boundary of one label.
using Ring = std::vector<std::uint32_t>;

/// Returns the boundary of the faces with one label as simple rings. An edge is on the boundary if its mate is missing
/// or has another label. Uses the bit `mark` of `visited` for each half-edge. Calls for different labels may run at the
/// same time.
[[nodiscard]] std::vector<Ring> boundary_rings(const Mesh& mesh, const std::vector<std::uint32_t>& labels,
                                               std::span<const std::uint32_t> faces, std::vector<std::uint8_t>& visited,
                                               std::uint8_t mark);

/// Builder of polygons from rings. Assigns holes to outer rings in the plane of `normal`. Drops vertices that `kept`
/// does not mark, and rings with fewer than three vertices.
class PolygonMaker {
 public:
  PolygonMaker(const PolygonModel& model, const Mesh& mesh, const std::vector<std::uint8_t>& kept)
      : model_(model), mesh_(mesh), kept_(kept) {}

  void add(std::vector<Ring> rings, const glm::dvec3& normal, bool textured, OutlinePolygons& to) const;
  /// Appends an unchanged face, as one ring.
  void add_face(std::uint32_t face, OutlinePolygons& to) const;

 private:
  void add_ring(const Ring& ring, bool textured, OutlinePolygons& to) const;
  void close_polygon(double area, OutlinePolygons& to) const;

  const PolygonModel& model_;
  const Mesh& mesh_;
  const std::vector<std::uint8_t>& kept_;
};

/// Reports whether the rings are the boundary of a flat surface without overlap. It must have one outer ring, no
/// crossings, and the same area as the faces. Also returns false if the test, or bridges to the holes, would take too
/// long.
[[nodiscard]] bool bounds_surface(const Mesh& mesh, const std::vector<Ring>& rings, const glm::dvec3& normal,
                                  double area);

/// Returns the vertices of `boundary` half-edges to keep. A chain ends at vertices with other than two edges.
/// Simplifies each chain within `tolerance` (Douglas & Peucker 1973), once for all rings that pass it. If `tolerance`
/// is negative, keeps all vertices.
[[nodiscard]] std::vector<std::uint8_t> kept_vertices(const Mesh& mesh, const std::vector<std::uint8_t>& boundary,
                                                      double tolerance);

}  // namespace gs::qnv::outline
