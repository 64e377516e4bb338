#pragma once

#include "qnv/exact/exact_mesh.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// A mesh as it was read, its vertices on the lattice: `mesh` is in units of the longest edge of the stream's box, from
/// its lower corner on (displaced::Frame), and parted where it is no manifold. `bits`: kLeastBits to kMostBits.
[[nodiscard]] ExactMesh quantized(displaced::SurfaceMesh mesh, int bits);

/// Cells of the lattice, 2^cell_bits an axis, and their ranks from 0 to 7 (mesh_growth.h, cell_of): a mesh grows where
/// they are low first, as far as it is joined.
struct TailRanks {
  int cell_bits = 0;
  std::vector<std::uint8_t> of;
};
struct TailOrder {
  std::vector<std::uint32_t> vertices;   // the number that each has when it is read; kNone: no triangle has it
  std::vector<std::uint32_t> triangles;  // as they come when it is read, those of the mesh
};

/// The bytes of a mesh, of which every edge has one triangle a side or is a rim, and the triangles round every vertex
/// are one fan, as `quantized` gives it. The same bytes for the same mesh. `usual`: without weights of its own, of which
/// small meshes are worth none. `ranks`: in which order it grows; null: in that which takes the fewest bytes. `order`: set
/// to that in which it is read.
[[nodiscard]] std::vector<std::byte> encode_tail(const ExactMesh& mesh, bool usual = false,
                                                 const TailRanks* ranks = nullptr, TailOrder* order = nullptr);

/// The same mesh, in another order. Nothing where the bytes are no tail, or have more than so many vertices. Safe for
/// untrusted bytes: memory and time are in proportion to them.
[[nodiscard]] std::optional<ExactMesh> decode_tail(std::span<const std::byte> bytes, std::size_t most_vertices);

/// How much is in a tail; nothing where it is none. Safe for untrusted bytes.
struct TailSize {
  int bits = 0;
  std::uint32_t vertices = 0, triangles = 0;
};
[[nodiscard]] std::optional<TailSize> tail_size(std::span<const std::byte> tail);

}  // namespace gs::qnv::exact
