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
  std::optional<exact::Cover> cover;             // patches of the previous stage that it covers
  std::vector<std::vector<std::byte>> low_bits;  // follow the tail
  std::size_t low_bytes = 0;
  std::vector<std::byte> picture;  // of its texture; empty if it has none
  std::size_t picture_first = 0;   // bytes of the picture before the mesh
  std::size_t picture_fine = 0;    // bytes of the picture before the finer parts of the mesh
  std::vector<std::byte> normals;  // of its corners, if no shading rule reproduces them
  bool parity = false;
  /// Returns the total size, including everything that follows the tail.
  [[nodiscard]] std::size_t size() const { return bytes.size() + low_bytes + picture.size() + normals.size(); }
};

/// Returns the whole source on a lattice of `bits` bits per axis; 0 chooses the bits from the size of its triangles.
[[nodiscard]] exact::ExactMesh exact_mesh_of(const displaced::MeshBuilder& builder, const displaced::Frame& frame,
                                             bool colored, int bits);

/// Returns a textured surface on the lattice; its positions have the same origin.
[[nodiscard]] exact::ExactMesh exact_mesh_of(const TexturedSurface& surface, const displaced::Frame& frame, int bits);

/// Encodes a tail of `bits` bits; finer bits of the mesh follow it as low bits. `ranks` and `order` are as in
/// encode_tail().
[[nodiscard]] SurfaceTail tail_of(const exact::ExactMesh& mesh, int bits, const exact::TailRanks* ranks = nullptr,
                                  exact::TailOrder* order = nullptr);
/// Adds the surface's texture, if the mesh has texture coordinates.
void set_picture(SurfaceTail& tail, const TexturedSurface& surface);
/// Returns the approximate size of a tail, including its low bits.
[[nodiscard]] std::size_t rough_tail_size(const exact::ExactMesh& mesh, int bits);
/// Returns the bits of the tail itself if it should arrive soon; finer bits follow it.
[[nodiscard]] int first_tail_bits(const exact::ExactMesh& mesh);
/// Returns the bits of the tail itself that approximately minimise the total size; prefers fewer bits among near-equal
/// choices.
[[nodiscard]] int fewest_tail_bits(const exact::ExactMesh& mesh);

/// Default number of position bits in the tail. Finer bits follow, and any part of those refines the mesh.
inline constexpr int kTailBits = 12;

/// Appends the tail in pieces after `others`, which it replaces.
void append_tail(const SurfaceTail& tail, const Box& box, std::vector<OutgoingChunk>& others);

}  // namespace gs::qnv
