#pragma once

#include "qnv/outline/outline_groups.h"
#include "qnv/outline/outline_record_encode.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

// Polygons of outline groups, put on the lattice. Only for the encoder of outline streams.
namespace gs::qnv::outline {

/// Rings on the lattice, one polygon after the other.
struct LatticeRings {
  std::vector<Corner> corners;
  std::vector<std::uint32_t> ring_ends;
};

/// A polygon on the lattice that is to become a record.
struct Placed {
  std::uint32_t group = 0;
  bool textured = false;
  std::size_t first_corner = 0, first_ring = 0, rings = 0;
};

/// Polygons in the order of the stream.
struct PolygonPool {
  LatticeRings rings;
  std::vector<Placed> polygons;
  [[nodiscard]] Polygon view(std::size_t polygon) const;
};

/// The lattices of a stream: steps are powers of two, as fine as `position_bits` allow, or as coarse as what lies
/// on them allows. Nothing where the model is too far from the origin for its size, or has no polygon.
struct Lattices {
  OutlineLattice<3> positions;
  OutlineLattice<2> texture_coordinates;
};
[[nodiscard]] std::optional<Lattices> choose_lattices(const OutlineGroups& groups, int position_bits, int texture_bits);

/// More corners than this would not be sure to fit into a record.
[[nodiscard]] std::size_t most_corners(const LatticeBits& bits);

/// Outlines, or inner polygons, of all groups in an order of groups; in a group by area, largest first. What has no
/// area on the lattice is left out; what has too many corners is cut. False where that failed.
[[nodiscard]] bool place_polygons(const OutlineGroups& groups, std::span<const std::uint32_t> order, bool inner,
                                  const Lattices& lattices, std::size_t most_corners, PolygonPool& pool);

/// Cuts a polygon in two halves of about as many corners, along a line of the lattice: appends their polygons, one
/// a LatticeRings. False where it cannot, for its rings cross.
[[nodiscard]] bool cut_polygon(const Polygon& polygon, std::vector<LatticeRings>& pieces);

/// Leaves out corners like the one before them, and rings of fewer than three. Nothing is left of a polygon whose outer
/// ring goes, or that is a triangle without area.
void clean(LatticeRings& rings);

}  // namespace gs::qnv::outline
