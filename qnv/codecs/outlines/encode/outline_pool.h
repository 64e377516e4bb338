#pragma once

#include "qnv/codecs/outlines/encode/outline_record_encode.h"
#include "qnv/codecs/outlines/grouping/outline_groups.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

// Polygons of outline groups on the lattice. Internal to the encoder of outline streams.
namespace gs::qnv::outline {

/// Rings of polygons on the lattice, in flat arrays.
struct LatticeRings {
  std::vector<Corner> corners;
  std::vector<std::uint32_t> ring_ends;
};

/// Polygon of a pool that becomes a record.
struct Placed {
  std::uint32_t group = 0;
  bool textured = false;
  std::size_t first_corner = 0, first_ring = 0, rings = 0;
};

/// Polygons on the lattice, in the order of the stream.
struct PolygonPool {
  LatticeRings rings;
  std::vector<Placed> polygons;
  [[nodiscard]] Polygon view(std::size_t polygon) const;
};

/// Lattices of a stream. Steps are powers of two: as fine as `position_bits` allows, or coarser if all positions are on
/// a coarser lattice. choose_lattices() returns nullopt if there is no polygon, or if the model is too far from the
/// origin for its size.
struct Lattices {
  OutlineLattice<3> positions;
  OutlineLattice<2> texture_coordinates;
};
[[nodiscard]] std::optional<Lattices> choose_lattices(const OutlineGroups& groups, int position_bits, int texture_bits);

/// Returns a number of corners that fits into a record with any coordinates.
[[nodiscard]] std::size_t most_corners(const LatticeBits& bits);

/// Places polygons on the lattice: the outlines or the inner polygons of all groups. Groups follow `order`; within a
/// group, the largest polygon is first. Drops polygons without area on the lattice, and cuts those with too many
/// corners. Returns false if a cut failed.
[[nodiscard]] bool place_polygons(const OutlineGroups& groups, std::span<const std::uint32_t> order, bool inner,
                                  const Lattices& lattices, std::size_t most_corners, PolygonPool& pool);

/// Cuts a polygon along a line of the lattice into halves with about the same number of corners. Appends the resulting
/// polygons, one per LatticeRings. Returns false if the polygon's rings cross.
[[nodiscard]] bool cut_polygon(const Polygon& polygon, std::vector<LatticeRings>& pieces);

/// Removes repeated corners, and rings with fewer than three corners. Removes all rings if the outer ring is removed,
/// or if the polygon is a triangle without area.
void clean(LatticeRings& rings);

}  // namespace gs::qnv::outline
