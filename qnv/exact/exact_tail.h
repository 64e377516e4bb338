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

/// The bytes of a mesh, of which every edge has one triangle a side or is a rim, and the triangles round every vertex
/// are one fan, as `quantized` gives it. The same bytes for the same mesh. `usual`: without weights of its own, of which
/// small meshes are worth none. `numbers`: set to those that vertices have when it is read, kNone of those that no
/// triangle has.
[[nodiscard]] std::vector<std::byte> encode_tail(const ExactMesh& mesh, bool usual = false,
                                                 std::vector<std::uint32_t>* numbers = nullptr);

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
