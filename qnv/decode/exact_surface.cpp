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
  if (auto tail = pieces_.take()) {
    tail_ = std::move(*tail);
    make(box, most_vectors);
  }
}

void ExactSurface::add_shading(std::span<const std::byte> payload, const Box& box, std::size_t most_vectors) {
  const auto shading = exact::decode_shading(payload);
  if (!shading || (shading_ && *shading_ != *shading)) {
    ++count_.refused;
    return;
  }
  if (shading_) return;
  shading_ = shading;
  if (whole_) make(box, most_vectors);
}

void ExactSurface::make(const Box& box, std::size_t most_vectors) {
  done_ = true;
  whole_ = false;
  count_.vectors = 0;
  const auto size = exact::tail_size(tail_);
  if (size && (size->vertices > most_vectors || size->triangles / 2 > most_vectors)) {
    count_.full = true;
    return;
  }
  const auto mesh = exact::decode_tail(tail_, most_vectors);
  if (!mesh) {
    ++count_.refused;
    return;
  }
  shown_ = shaded_vertices(*mesh, shading_.value_or(exact::Shading{exact::Shading::Rule::edges, mesh->crease_angle}), box);
  if (shading_) tail_ = {};
  if (shown_.positions.size() > most_vectors) {
    count_.full = true;
    shown_ = {};
    return;
  }
  whole_ = true;
  bits_ = mesh->bits;
  count_.vectors = shown_.positions.size();
  ++count_.taken;
}

void ExactSurface::append(Cloud& cloud, bool colored) const { shown_.append(cloud, colored); }

}  // namespace gs::qnv
