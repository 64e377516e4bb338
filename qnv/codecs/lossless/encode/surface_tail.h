#pragma once

#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/lossless/cover.h"
#include "qnv/codecs/lossless/exact_tail.h"
#include "qnv/codecs/lossless/picture.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/stream_writer.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace gs::qnv {

/// Exact mesh for the end of a stream.
struct SurfaceTail {
  std::vector<std::byte> bytes;  // empty if there is no tail
  std::size_t vertices = 0;
  exact::Shading shading;
  std::optional<exact::Cover> cover;  // patches of the previous stage that the mesh covers
  std::vector<std::vector<std::byte>> low_bits;  // chunks that follow the tail
  std::size_t low_bytes = 0;
  std::vector<std::byte> picture;  // texture files; empty if the mesh has no texture
  std::size_t picture_first = 0;  // bytes of `picture` that are sent before the mesh
  std::size_t picture_fine = 0;  // bytes of `picture` that are sent before the normals and low bits of the mesh
  std::vector<std::byte> normals;  // encoded normals of corners; empty if a shading rule reproduces them
  bool parity = false;
  /// Returns the total size in bytes, including everything that follows the tail.
  [[nodiscard]] std::size_t size() const { return bytes.size() + low_bytes + picture.size() + normals.size(); }
};

/// Returns the whole source on a lattice with `bits` bits per axis. If `bits` is 0, derives it from the size of the
/// triangles.
[[nodiscard]] exact::ExactMesh exact_mesh_of(const displaced::MeshBuilder& builder, const displaced::Frame& frame,
                                             bool colored, int bits);

/// Returns a textured surface on the lattice. Its positions must have the same origin as `frame`.
[[nodiscard]] exact::ExactMesh exact_mesh_of(const TexturedSurface& surface, const displaced::Frame& frame, int bits);

/// Encodes a tail with `bits` bits per axis. The remaining bits of the mesh follow as low bits. encode_tail() describes
/// `ranks` and `order`.
[[nodiscard]] SurfaceTail tail_of(const exact::ExactMesh& mesh, int bits, const exact::TailRanks* ranks = nullptr,
                                  exact::TailOrder* order = nullptr);
/// Adds the surface's texture to `tail`, if the mesh has texture coordinates.
void set_picture(SurfaceTail& tail, const TexturedSurface& surface);
/// Returns the approximate size in bytes of a tail with `bits` bits, including its low bits.
[[nodiscard]] std::size_t rough_tail_size(const exact::ExactMesh& mesh, int bits);
/// Returns the bits per axis for a tail that should be received soon; the remaining bits follow as low bits.
[[nodiscard]] int first_tail_bits(const exact::ExactMesh& mesh);
/// Returns the bits per axis that approximately minimise the total size. Among near-equal sizes, returns fewer bits.
[[nodiscard]] int fewest_tail_bits(const exact::ExactMesh& mesh);

/// Default bits per axis of positions in the tail. Low bits follow; any part of them refines the mesh.
inline constexpr int kTailBits = 12;

/// Appends the tail in pieces to `others`, the chunks that it replaces.
void append_tail(const SurfaceTail& tail, const Box& box, std::vector<OutgoingChunk>& others);

}  // namespace gs::qnv
