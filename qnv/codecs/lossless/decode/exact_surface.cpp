#include "qnv/codecs/lossless/decode/exact_surface.h"

#include "qnv/codecs/lossless/exact_tail.h"
#include "qnv/codecs/lossless/own_normals.h"

#include <algorithm>
#include <utility>

namespace gs::qnv {

void ExactSurface::add(ChunkType type, std::span<const std::byte> payload) {
  switch (type) {
    case ChunkType::exact:
      return add_tail(payload);
    case ChunkType::shading:
      return add_shading(payload);
    case ChunkType::low_bits:
      return add_low_bits(payload);
    case ChunkType::cover:
      return add_cover(payload);
    case ChunkType::picture:
      return add_picture(payload);
    case ChunkType::normals:
      return add_normals(payload);
    default:
      ++count_.refused;
  }
}

void ExactSurface::add_tail(std::span<const std::byte> payload) {
  if (done_) return;
  if (!pieces_.add(payload)) {
    ++count_.refused;
    return;
  }
  if (!reader_) reader_.emplace(pieces_.length(), most_vectors_);
  const std::size_t before = reader_->triangles();
  reader_->push(pieces_.next());
  using State = exact::TailReader::State;
  const State state = reader_->state();
  if (reader_->triangles() != before || state != State::growing) shown_.reset();
  if (state == State::growing) {
    if (cover() && reader_->triangles() != before) ++count_.taken;
    return;
  }
  done_ = true;
  if (state == State::full) count_.full = true;
  if (state == State::whole) mesh_ = reader_->mesh();
  read_normals();
  if (state != State::full) ++(mesh_ ? count_.taken : count_.refused);
  reader_.reset();
  (void)pieces_.take();
}

void ExactSurface::add_cover(std::span<const std::byte> payload) {
  auto cover = exact::decode_cover(payload);
  if (!cover) {
    ++count_.refused;
    return;
  }
  if (cover_) return;
  cover_ = std::move(cover);
  if (this->cover()) ++count_.taken;
}

const exact::Cover* ExactSurface::cover() const {
  const bool fits = cover_ && reader_ && reader_->triangles() > 0 && reader_->all_triangles() == cover_->triangles;
  return fits && dressed() ? &*cover_ : nullptr;
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
  if (mesh_ || cover()) ++count_.taken;
}

void ExactSurface::add_low_bits(std::span<const std::byte> payload) {
  if (!low_bits_.add(payload)) {
    ++count_.refused;
    return;
  }
  shown_.reset();
  if (mesh_ || cover()) ++count_.taken;
}

void ExactSurface::add_picture(std::span<const std::byte> payload) {
  const bool whole = picture_.whole();
  const auto before = picture_.picture();
  if (!picture_.add(payload)) {
    ++count_.refused;
    return;
  }
  if (picture_.picture() != before || picture_.whole() != whole) ++count_.taken;
}

void ExactSurface::add_normals(std::span<const std::byte> payload) {
  if (normal_pieces_.length() != 0 && normal_pieces_.come() == normal_pieces_.length()) return;
  if (!normal_pieces_.add(payload)) {
    ++count_.refused;
    return;
  }
  if (auto all = normal_pieces_.take()) normal_bytes_ = std::move(*all);
  read_normals();
}

void ExactSurface::read_normals() {
  if (!mesh_ || normal_bytes_.empty()) return;
  // Uses the tail's own shading rule, because low bits and shading chunks may be received earlier or later.
  const exact::Shading own{exact::Shading::Rule::edges, mesh_->crease_angle};
  auto normals = exact::decode_normals(normal_bytes_, *mesh_, exact::shaded_normals(*mesh_, own));
  normal_bytes_ = {};
  ++(normals ? count_.taken : count_.refused);
  if (!normals) return;
  own_normals_ = std::move(*normals);
  shown_.reset();
}

bool ExactSurface::finest() const { return mesh_ && low_bits_.complete(*mesh_) && (!textured() || picture_.whole()); }

MeshProgress ExactSurface::progress() const {
  MeshProgress progress;
  progress.bytes = pieces_.length();
  progress.received = pieces_.come();
  progress.texture_bytes = picture_.length();
  progress.texture_received = picture_.come();
  progress.triangles = triangles();
  if (const exact::Cover* part = cover()) {
    progress.partly = true;
    progress.all_triangles = part->triangles;
  }
  progress.bits = mesh_ ? std::max(mesh_->bits, mesh_->finest) : 0;
  progress.whole = whole();
  progress.final = finest();
  return progress;
}

const IndexedMesh& ExactSurface::shown() const {
  if (shown_) return *shown_;
  exact::ExactMesh mesh = mesh_ ? *mesh_ : reader_->mesh();
  low_bits_.apply(mesh);
  const exact::Shading own{exact::Shading::Rule::edges, mesh.crease_angle};
  if (mesh_ && !own_normals_.empty()) {
    shown_ = shaded_mesh(mesh, own_normals_, box_);
  } else {
    shown_ = shaded_mesh(mesh, exact::shaded_normals(mesh, shading_.value_or(own)), box_);
  }
  // Without creases, there are at most as many drawn vertices as mesh vertices.
  if (shown_->positions.size() > most_vectors_)
    shown_ = shaded_mesh(mesh, exact::shaded_normals(mesh, exact::Shading{}), box_);
  return *shown_;
}

void ExactSurface::append(IndexedMesh& mesh, bool colored) const {
  append_mesh(shown(), mesh, colored);
  if (textured()) mesh.picture = picture_.picture();
}

}  // namespace gs::qnv
