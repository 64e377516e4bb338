#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Quantises a welded mesh to a lattice of `bits` bits per axis, kMinBits to kMaxBits. `mesh` is in units of the
/// longest edge of the stream's box, relative to the box's lower corner (displaced::Frame). Splits non-manifold
/// vertices.
[[nodiscard]] ExactMesh quantized(displaced::SurfaceMesh mesh, int bits);

/// Ranks of the cells of a lattice, 0 to 7. There are 2^cell_bits cells per axis (cell_of() in tail_header.h). The mesh
/// grows through connected cells of low rank first.
struct TailRanks {
  int cell_bits = 0;
  std::vector<std::uint8_t> of;
};
struct TailOrder {
  std::vector<std::uint32_t> vertices;  // decoding index of each vertex; kNone if no triangle uses it
  std::vector<std::uint32_t> triangles;  // indices of the mesh's triangles, in decoding order
};

/// Encodes a mesh that quantized() returned. Deterministic. `usual` selects the default prediction weights, because
/// fitted weights do not pay for small meshes. `ranks` sets the order of growth; if nullptr, uses the order with the
/// smallest encoding. Writes the decoding order to `order` unless it is nullptr. Every edge of the mesh must have one
/// triangle per side or be a rim, and each vertex one fan.
[[nodiscard]] std::vector<std::byte> encode_tail(const ExactMesh& mesh, bool usual = false,
                                                 const TailRanks* ranks = nullptr, TailOrder* order = nullptr);

/// Decodes a mesh; its vertices and triangles have another order. Returns nullopt if the bytes are not a tail or have
/// more than `most_vertices` vertices. Safe for untrusted bytes: memory and time are proportional to the number of
/// bytes.
[[nodiscard]] std::optional<ExactMesh> decode_tail(std::span<const std::byte> bytes, std::size_t most_vertices);

}  // namespace gs::qnv::exact
