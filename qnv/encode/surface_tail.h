#pragma once

#include "qnv/displaced/surface.h"
#include "qnv/encode/encode_surface.h"
#include "qnv/encode/stream_writer.h"
#include "qnv/exact/cover.h"
#include "qnv/exact/exact_tail.h"
#include "qnv/exact/picture.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace gs::qnv {

/// The mesh itself, as it comes at the end of a displaced stream.
struct SurfaceTail {
  std::vector<std::byte> bytes;  // none: there is no tail
  std::size_t vertices = 0;
  exact::Shading shading;
  std::optional<exact::Cover> cover;             // what of the stage before it covers
  std::vector<std::vector<std::byte>> low_bits;  // behind it
  std::size_t low_bytes = 0;
  std::vector<std::byte> picture;  // of its texture; none: it has none
  std::size_t picture_first = 0;   // of its bytes: come before the mesh
  std::size_t picture_fine = 0;    // likewise, before what is finer of the mesh
  std::vector<std::byte> normals;  // of its corners, where no rule gives them
  bool parity = false;
  /// With what comes behind it.
  [[nodiscard]] std::size_t size() const { return bytes.size() + low_bytes + picture.size() + normals.size(); }
};

/// All of a source on a lattice of so many bits an axis; `bits` 0: of as many as its triangles are worth.
[[nodiscard]] exact::ExactMesh exact_mesh_of(const displaced::MeshBuilder& builder, const displaced::Frame& frame,
                                             bool colored, int bits);

/// The same of a textured surface, whose places count from the same origin.
[[nodiscard]] exact::ExactMesh exact_mesh_of(const TexturedSurface& surface, const displaced::Frame& frame, int bits);

/// `bits`: of the tail itself; those of the mesh that are finer come behind it. `ranks`, `order`: as encode_tail has
/// them.
[[nodiscard]] SurfaceTail tail_of(const exact::ExactMesh& mesh, int bits, const exact::TailRanks* ranks = nullptr,
                                  exact::TailOrder* order = nullptr);
/// That of the surface's texture, where the mesh has one.
void set_picture(SurfaceTail& tail, const TexturedSurface& surface);
/// About how many bytes a tail takes, with what comes behind it.
[[nodiscard]] std::size_t rough_tail_size(const exact::ExactMesh& mesh, int bits);
/// How many bits are in the tail itself where it is to be there soon; what is finer comes behind it.
[[nodiscard]] int first_tail_bits(const exact::ExactMesh& mesh);
/// With how many bits in the tail itself it takes about the fewest bytes; fewer where that is no matter.
[[nodiscard]] int fewest_tail_bits(const exact::ExactMesh& mesh);

/// What of places is finer than this comes behind the tail: any part of it makes the mesh finer.
inline constexpr int kTailBits = 12;

/// In pieces, behind `others`, whose place it takes.
void append_tail(const SurfaceTail& tail, const Box& box, std::vector<OutgoingChunk>& others);

}  // namespace gs::qnv
