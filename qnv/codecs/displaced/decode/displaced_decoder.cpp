#include "qnv/codecs/displaced/decode/surface_stages.h"
#include "qnv/codecs/lossless/decode/exact_surface.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

/// Decoder of the displaced payload. An exact mesh may follow the stages in the stream.
class DisplacedDecoder final : public Decoder {
 public:
  DisplacedDecoder(const StreamHeader& header, std::size_t most_vectors)
      : colored_(header.colored), most_vectors_(most_vectors), exact_(header.description.box, most_vectors) {
    stages_.begin(header.base, header.description.box, most_vectors);
  }

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) override {
    if (type == ChunkType::displaced)
      stages_.add(payload);
    else
      exact_.add(type, payload);
  }
  [[nodiscard]] DecodeCount count() const override {
    DecodeCount count = stages_.count();
    return count += exact_.count();
  }
  [[nodiscard]] std::size_t vectors() const override {
    if (exact_.whole()) return exact_.vectors();
    const std::vector<bool> without = covered();
    return without.empty() ? stages_.vectors() : stages_.vectors(without) + exact_.vectors();
  }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    IndexedMesh mesh(std::move(base));
    const std::vector<bool> without = covered();
    if (!exact_.whole()) stages_.append(mesh, colored_, without);
    if (exact_.whole() || !without.empty()) exact_.append(mesh, colored_);
    return mesh;
  }
  /// Returns patches, unless a part of the exact mesh is shown.
  [[nodiscard]] Geometry geometry_to_draw(GeometryBase base) override {
    if (exact_.whole() || !covered().empty()) return geometry(std::move(base));
    return stages_.patches(std::move(base));
  }
  [[nodiscard]] MeshProgress mesh() const override { return exact_.progress(); }

 private:
  /// Returns one flag per patch: true if received triangles of the exact mesh cover the patch. Returns an empty list if
  /// no part of the exact mesh is drawn.
  [[nodiscard]] std::vector<bool> covered() const {
    const exact::Cover* cover = exact_.cover();
    const SurfaceStages::Shown main = stages_.main();
    if (!cover || !main.surface || main.number != cover->stage ||
        main.surface->patches().size() != cover->patches.size() || stages_.vectors() + exact_.vectors() > most_vectors_)
      return {};
    std::vector<bool> covered;
    for (std::size_t p = 0; p < cover->patches.size(); ++p) covered.push_back(cover->covered(p, exact_.triangles()));
    return covered;
  }

  bool colored_;
  std::size_t most_vectors_;
  SurfaceStages stages_;
  ExactSurface exact_;  // exact mesh; replaces the stages when it is complete
};

}  // namespace

std::unique_ptr<Decoder> make_displaced_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<DisplacedDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
