#include "qnv/codecs/progressive/decode/progressive_decoder.h"

#include "qnv/codecs/lossless/own_normals.h"

#include <utility>

namespace gs::qnv {

ProgressiveDecoder::ProgressiveDecoder(const StreamHeader& header, std::size_t most_vectors)
    : colored_(header.colored), box_(header.description.box), exact_(header.description.box, most_vectors) {
  count_.full = progressive::promises_more(header.base, most_vectors);
  const bool good = count_.full || mesh_.begin(header.base, most_vectors);
  ++(good ? count_.taken : count_.refused);
}

void ProgressiveDecoder::add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) {
  if (type != ChunkType::splits) return exact_.add(type, payload);
  if (count_.full) return;
  const std::size_t before = mesh_.segments();
  if (!mesh_.add(payload)) ++count_.refused;
  if (mesh_.segments() == before) return;
  count_.taken += mesh_.segments() - before;
  shown_.reset();
}

Geometry ProgressiveDecoder::geometry(GeometryBase base) const {
  IndexedMesh mesh(std::move(base));
  if (exact_.whole())
    exact_.append(mesh, colored_);
  else if (mesh_.begun())
    append_mesh(shown(), mesh, colored_);
  return mesh;
}

DecodeCount ProgressiveDecoder::count() const {
  DecodeCount count = count_;
  return count += exact_.count();
}

std::size_t ProgressiveDecoder::vectors() const {
  if (exact_.whole()) return exact_.vectors();
  return mesh_.begun() ? shown().positions.size() : 0;
}

MeshProgress ProgressiveDecoder::mesh() const {
  MeshProgress progress = exact_.progress();
  progress.vertices = mesh_.vertices();
  if (!progress.whole) progress.bits = mesh_.bits();
  progress.growing = mesh_.begun();
  progress.final = progress.final || mesh_.whole();
  return progress;
}

const IndexedMesh& ProgressiveDecoder::shown() const {
  if (!shown_) {
    const exact::ExactMesh mesh = mesh_.mesh();
    shown_ = shaded_mesh(mesh, exact::shaded_normals(mesh, mesh.shading), box_);
  }
  return *shown_;
}

}  // namespace gs::qnv
