#include "qnv/decode/exact_surface.h"

#include "qnv/exact/exact_tail.h"

#include <utility>

namespace gs::qnv {

void ExactSurface::add(std::span<const std::byte> payload, const Box& box, std::size_t most_vectors) {
  if (done_) return;
  if (!pieces_.add(payload)) {
    ++count_.refused;
    return;
  }
  const auto tail = pieces_.take();
  if (!tail) return;
  done_ = true;
  box_ = box;
  most_vectors_ = most_vectors;
  const auto size = exact::tail_size(*tail);
  if (size && (size->vertices > most_vectors || size->triangles / 2 > most_vectors)) {
    count_.full = true;
    return;
  }
  mesh_ = exact::decode_tail(*tail, most_vectors);
  ++(mesh_ ? count_.taken : count_.refused);
}

void ExactSurface::add_shading(std::span<const std::byte> payload) {
  const auto shading = exact::decode_shading(payload);
  if (!shading || (shading_ && *shading_ != *shading)) {
    ++count_.refused;
    return;
  }
  if (shading_) return;
  shading_ = shading;
  shown_.reset();
  if (mesh_) ++count_.taken;
}

void ExactSurface::add_low_bits(std::span<const std::byte> payload) {
  if (!low_bits_.add(payload)) {
    ++count_.refused;
    return;
  }
  shown_.reset();
  if (mesh_) ++count_.taken;
}

bool ExactSurface::finest() const { return mesh_ && low_bits_.complete(*mesh_); }

const ShadedVertices& ExactSurface::shown() const {
  if (shown_) return *shown_;
  exact::ExactMesh mesh = *mesh_;
  low_bits_.apply(mesh);
  const exact::Shading own{exact::Shading::Rule::edges, mesh.crease_angle};
  shown_ = shaded_vertices(mesh, shading_.value_or(own), box_);
  // Without creases there are no more of them than vertices.
  if (shown_->positions.size() > most_vectors_) shown_ = shaded_vertices(mesh, exact::Shading{}, box_);
  return *shown_;
}

void ExactSurface::append(Cloud& cloud, bool colored) const { shown().append(cloud, colored); }

}  // namespace gs::qnv
