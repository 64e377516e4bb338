#include "qnv/codecs/displaced/decode/displaced_decoder.h"

#include <utility>

namespace gs::qnv {

DisplacedDecoder::DisplacedDecoder(const StreamHeader& header, std::size_t most_vectors)
    : colored_(header.colored), most_vectors_(most_vectors), exact_(header.description.box, most_vectors) {
  stages_.begin(header.base, header.description.box, most_vectors);
}

void DisplacedDecoder::add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) {
  if (type == ChunkType::displaced)
    stages_.add(payload);
  else
    exact_.add(type, payload);
}

DecodeCount DisplacedDecoder::count() const {
  DecodeCount count = stages_.count();
  return count += exact_.count();
}

std::size_t DisplacedDecoder::vectors() const {
  if (exact_.whole()) return exact_.vectors();
  const std::vector<bool> without = covered();
  return without.empty() ? stages_.vectors() : stages_.vectors(without) + exact_.vectors();
}

Geometry DisplacedDecoder::geometry(GeometryBase base) const {
  IndexedMesh mesh(std::move(base));
  const std::vector<bool> without = covered();
  if (!exact_.whole()) stages_.append(mesh, colored_, without);
  if (exact_.whole() || !without.empty()) exact_.append(mesh, colored_);
  return mesh;
}

Geometry DisplacedDecoder::geometry_to_draw(GeometryBase base) {
  if (exact_.whole() || !covered().empty()) return geometry(std::move(base));
  return stages_.patches(std::move(base));
}

std::vector<bool> DisplacedDecoder::covered() const {
  const exact::Cover* cover = exact_.cover();
  const SurfaceStages::Shown main = stages_.main();
  if (!cover || !main.surface || main.number != cover->stage ||
      main.surface->patches().size() != cover->patches.size() || stages_.vectors() + exact_.vectors() > most_vectors_)
    return {};
  std::vector<bool> covered;
  for (std::size_t p = 0; p < cover->patches.size(); ++p) covered.push_back(cover->covered(p, exact_.triangles()));
  return covered;
}

}  // namespace gs::qnv
