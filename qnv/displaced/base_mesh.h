#pragma once

#include "qnv/displaced/manifold.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// A coarse mesh whose vertices lie on a lattice of 2^bits places an axis. Every edge has at most one triangle a side.
struct BaseMesh {
  int bits = 8;  // 1 to 16
  std::vector<glm::ivec3> vertices;
  std::vector<Corners> triangles;
  std::vector<bool> creases;  // of each edge in the order of Patches; empty: there are none
};

/// The bytes of a base mesh, and the mesh as it comes out of them: the same, in another order. It must be manifold, as
/// `simplify` gives it.
struct CodedBase {
  std::vector<std::byte> bytes;
  BaseMesh mesh;
  std::vector<std::uint32_t> source;  // of each vertex: its number before
};
/// `is_crease`: of two vertices of `mesh` with an edge between them.
[[nodiscard]] CodedBase encode_base(const BaseMesh& mesh,
                                    const std::function<bool(std::uint32_t, std::uint32_t)>& is_crease);

/// Nothing where the bytes are not a base mesh of at most so many triangles. Safe for untrusted bytes.
[[nodiscard]] std::optional<BaseMesh> decode_base(std::span<const std::byte> bytes, std::size_t most_triangles);

}  // namespace gs::qnv::displaced
