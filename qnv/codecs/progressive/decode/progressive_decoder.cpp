#include "qnv/codecs/lossless/decode/exact_surface.h"
#include "qnv/codecs/lossless/decode/shaded_mesh.h"
#include "qnv/codecs/lossless/own_normals.h"
#include "qnv/codecs/progressive/progressive.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace gs::qnv {
namespace {

/// Decoder of the progressive payload. An exact mesh may follow in the stream.
class ProgressiveDecoder final : public Decoder {
 public:
  ProgressiveDecoder(const StreamHeader& header, std::size_t most_vectors)
      : colored_(header.colored), box_(header.description.box), exact_(header.description.box, most_vectors) {
    count_.full = progressive::promises_more(header.base, most_vectors);
    const bool good = count_.full || mesh_.begin(header.base, most_vectors);
    ++(good ? count_.taken : count_.refused);
  }

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) override {
    if (type != ChunkType::splits) return exact_.add(type, payload);
    if (count_.full) return;
    const std::size_t before = mesh_.segments();
    if (!mesh_.add(payload)) ++count_.refused;
    if (mesh_.segments() == before) return;
    count_.taken += mesh_.segments() - before;
    shown_.reset();
  }
  [[nodiscard]] DecodeCount count() const override {
    DecodeCount count = count_;
    return count += exact_.count();
  }
  [[nodiscard]] std::size_t vectors() const override {
    if (exact_.whole()) return exact_.vectors();
    return mesh_.begun() ? shown().positions.size() : 0;
  }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    IndexedMesh mesh(std::move(base));
    if (exact_.whole())
      exact_.append(mesh, colored_);
    else if (mesh_.begun())
      append_mesh(shown(), mesh, colored_);
    return mesh;
  }
  [[nodiscard]] MeshProgress mesh() const override {
    MeshProgress progress = exact_.progress();
    progress.vertices = mesh_.vertices();
    if (!progress.whole) progress.bits = mesh_.bits();
    progress.growing = mesh_.begun();
    progress.final = progress.final || mesh_.whole();
    return progress;
  }

 private:
  /// Returns the mesh received so far; recomputes it after changes.
  [[nodiscard]] const IndexedMesh& shown() const {
    if (!shown_) {
      const exact::ExactMesh mesh = mesh_.mesh();
      shown_ = shaded_mesh(mesh, exact::shaded_normals(mesh, mesh.shading), box_);
    }
    return *shown_;
  }

  bool colored_;
  Box box_;
  progressive::ProgressiveMesh mesh_;
  DecodeCount count_;
  mutable std::optional<IndexedMesh> shown_;
  ExactSurface exact_;  // exact mesh; replaces the growing mesh when it is complete
};

}  // namespace

std::unique_ptr<Decoder> make_progressive_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<ProgressiveDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
