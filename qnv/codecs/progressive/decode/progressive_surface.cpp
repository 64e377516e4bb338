#include "qnv/codecs/progressive/decode/progressive_surface.h"

#include "qnv/codecs/lossless/own_normals.h"

namespace gs::qnv {

bool ProgressiveSurface::begin(std::span<const std::byte> front, const Box& box, std::size_t most_vectors) {
  box_ = box;
  count_.full = progressive::promises_more(front, most_vectors);
  if (!count_.full && !mesh_.begin(front, most_vectors)) return false;
  ++count_.taken;
  return true;
}

void ProgressiveSurface::add(std::span<const std::byte> payload) {
  if (count_.full) return;
  const std::size_t before = mesh_.segments();
  if (!mesh_.add(payload)) ++count_.refused;
  if (mesh_.segments() == before) return;
  count_.taken += mesh_.segments() - before;
  shown_.reset();
}

const ShadedVertices& ProgressiveSurface::shown() const {
  if (!shown_) {
    const exact::ExactMesh mesh = mesh_.mesh();
    shown_ = shaded_vertices(mesh, exact::shaded_normals(mesh, mesh.shading), box_);
  }
  return *shown_;
}

}  // namespace gs::qnv
