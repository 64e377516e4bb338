#pragma once

#include "qnv/mesh/manifold.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Coarse mesh with vertices on a lattice of 2^bits positions per axis. Every edge has at most one triangle per side.
struct BaseMesh {
  int bits = 8;  // 1 to 16
  std::vector<glm::ivec3> vertices;
  std::vector<Corners> triangles;
  std::vector<bool> creases;  // one per edge, in the order of Patches; empty if the mesh has no creases
};

/// Encoded base mesh, and the mesh that a decoder obtains: equal but reordered. The mesh must be manifold, like the
/// results of simplify().
struct CodedBase {
  std::vector<std::byte> bytes;
  BaseMesh mesh;
  std::vector<std::uint32_t> source;  // original index of each vertex
};
/// Encodes a base mesh. Calls `is_crease` with two vertices of `mesh` that share an edge.
[[nodiscard]] CodedBase encode_base(const BaseMesh& mesh,
                                    const std::function<bool(std::uint32_t, std::uint32_t)>& is_crease);

/// Decodes a base mesh. Returns nullopt if the bytes are not a base mesh of at most `most_triangles` triangles. Safe
/// for untrusted bytes.
[[nodiscard]] std::optional<BaseMesh> decode_base(std::span<const std::byte> bytes, std::size_t most_triangles);

}  // namespace gs::qnv::displaced
