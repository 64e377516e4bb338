#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Quantises a welded mesh to the lattice. `mesh` is in units of the longest edge of the stream's box, from its lower
/// corner (displaced::Frame). Splits non-manifold vertices. `bits` is kMinBits to kMaxBits.
[[nodiscard]] ExactMesh quantized(displaced::SurfaceMesh mesh, int bits);

/// Ranks from 0 to 7 of the lattice's cells, 2^cell_bits per axis (cell_of() in tail_header.h). The mesh grows through
/// connected cells of low rank first.
struct TailRanks {
  int cell_bits = 0;
  std::vector<std::uint8_t> of;
};
struct TailOrder {
  std::vector<std::uint32_t> vertices;   // decoded number of each vertex; kNone if no triangle uses it
  std::vector<std::uint32_t> triangles;  // in decoding order, as numbers of the mesh
};

/// Encodes a mesh as returned by quantized(): every edge has one triangle per side or is a rim, and each vertex has
/// one fan. Deterministic. `usual` omits weights of its own, which do not pay for small meshes. `ranks` sets the order
/// of growth; nullptr selects the smallest encoding. Fills `order`, if given, with the decoding order.
[[nodiscard]] std::vector<std::byte> encode_tail(const ExactMesh& mesh, bool usual = false,
                                                 const TailRanks* ranks = nullptr, TailOrder* order = nullptr);

/// Decodes a mesh, in another order. Returns nullopt if the bytes are not a tail or have more than `most_vertices`
/// vertices. Safe for untrusted bytes: memory and time are proportional to them.
[[nodiscard]] std::optional<ExactMesh> decode_tail(std::span<const std::byte> bytes, std::size_t most_vertices);

/// Size of a tail. tail_size() returns nullopt for other data. Safe for untrusted bytes.
struct TailSize {
  int bits = 0;
  std::uint32_t vertices = 0, triangles = 0;
};
[[nodiscard]] std::optional<TailSize> tail_size(std::span<const std::byte> tail);

}  // namespace gs::qnv::exact
