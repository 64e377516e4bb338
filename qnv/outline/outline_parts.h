#pragma once

#include "qnv/outline/outline_mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// The steps from a mesh to outline groups, one file each. Only for group_outlines.
namespace gs::qnv::outline {

/// Faces by what they belong to, numbered from 0.
struct Labels {
  std::vector<std::uint32_t> of;  // of each face
  std::uint32_t count = 0;

  /// Gives numbers in the order in which the labels come.
  void renumber();
};

/// The faces of each label one after the other.
struct FaceLists {
  explicit FaceLists(const Labels& labels);
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::uint32_t label) const {
    return std::span(faces_).subspan(begins_[label], begins_[label + 1] - begins_[label]);
  }

 private:
  std::vector<std::uint32_t> begins_, faces_;
};

/// How far merging goes. Distances in units: of corners from the plane, of dropped vertices from an edge (negative:
/// none is dropped); of unit normals from each other.
struct MergeLimits {
  double distance = 0, angle = 0, line = -1;
  bool exact = true;  // so that the normal of the thinnest face counts: it would be seen
};
[[nodiscard]] MergeLimits merge_limits(const Mesh& mesh, const OutlineOptions& options);

/// Connected faces in one plane that can be merged: larger ones first take what fits their plane.
[[nodiscard]] Labels coplanar_regions(const PolygonModel& model, const Mesh& mesh, const MergeLimits& limits,
                                      unsigned threads);

/// Connected regions that are nearly in one plane: labels of faces.
[[nodiscard]] Labels cluster_regions(const Mesh& mesh, const Labels& regions, const OutlineOptions& options,
                                     Progress* progress);

/// A ring of half-edges of one label's faces, along where it ends.
using Ring = std::vector<std::uint32_t>;

/// The boundary of faces of one label as simple rings: an edge is part of it where its mate is missing or has another
/// label. `visited` has a bit of its own, `mark`, for each half-edge; calls for different labels may run at once.
[[nodiscard]] std::vector<Ring> boundary_rings(const Mesh& mesh, const std::vector<std::uint32_t>& labels,
                                               std::span<const std::uint32_t> faces, std::vector<std::uint8_t>& visited,
                                               std::uint8_t mark);

/// Appends polygons made of rings: which holes lie in which outer ring is told in the plane of `normal`. Vertices that
/// are not `kept` and rings that have fewer than three left are dropped.
class PolygonMaker {
 public:
  PolygonMaker(const PolygonModel& model, const Mesh& mesh, const std::vector<std::uint8_t>& kept)
      : model_(model), mesh_(mesh), kept_(kept) {}

  void add(std::vector<Ring> rings, const glm::dvec3& normal, bool textured, OutlinePolygons& to) const;
  /// A face as it is, as one ring.
  void add_face(std::uint32_t face, OutlinePolygons& to) const;

 private:
  void add_ring(const Ring& ring, bool textured, OutlinePolygons& to) const;
  void close_polygon(double area, OutlinePolygons& to) const;

  const PolygonModel& model_;
  const Mesh& mesh_;
  const std::vector<std::uint8_t>& kept_;
};

/// Whether the rings bound a flat surface once: one outer ring, holes, no crossing, an area that is that of the faces.
/// False too where to find out, or to make bridges to the holes, would take too long.
[[nodiscard]] bool bounds_surface(const Mesh& mesh, const std::vector<Ring>& rings, const glm::dvec3& normal,
                                  double area);

/// Which vertices of the half-edges that are `boundary` stay: chains between those where other than two edges meet are
/// simplified within `tolerance` (Douglas & Peucker 1973), once for all rings that pass them. Negative: all stay.
[[nodiscard]] std::vector<std::uint8_t> kept_vertices(const Mesh& mesh, const std::vector<std::uint8_t>& boundary,
                                                      double tolerance);

}  // namespace gs::qnv::outline
