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

/// Rings on the lattice, one polygon after another.
struct LatticeRings {
  std::vector<Corner> corners;
  std::vector<std::uint32_t> ring_ends;
};

/// Polygon on the lattice that becomes a record.
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

/// Lattices of a stream. Steps are powers of two, as fine as `position_bits` allows, or as coarse as the positions on
/// them allow. choose_lattices() returns nullopt if the model is too far from the origin for its size, or has no
/// polygon.
struct Lattices {
  OutlineLattice<3> positions;
  OutlineLattice<2> texture_coordinates;
};
[[nodiscard]] std::optional<Lattices> choose_lattices(const OutlineGroups& groups, int position_bits, int texture_bits);

/// Returns the maximum number of corners that surely fit into a record.
[[nodiscard]] std::size_t most_corners(const LatticeBits& bits);

/// Places the outlines or inner polygons of all groups, in the given order of groups, largest first within a group.
/// Drops polygons without area on the lattice, and cuts those with too many corners. Returns false if that failed.
[[nodiscard]] bool place_polygons(const OutlineGroups& groups, std::span<const std::uint32_t> order, bool inner,
                                  const Lattices& lattices, std::size_t most_corners, PolygonPool& pool);

/// Cuts a polygon along a line of the lattice into halves with about as many corners. Appends their polygons, one per
/// LatticeRings. Returns false if its rings cross.
[[nodiscard]] bool cut_polygon(const Polygon& polygon, std::vector<LatticeRings>& pieces);

/// Removes repeated corners, and rings of fewer than three. Removes the whole polygon if its outer ring goes or it is a
/// triangle without area.
void clean(LatticeRings& rings);

}  // namespace gs::qnv::outline
