#include "qnv/codecs/records/decode/records_decoder.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <variant>

namespace gs::qnv {

RecordsDecoder::RecordsDecoder(const StreamHeader& header, std::size_t most_vectors)
    : kind_(header.kind), palette_(header.palette), most_vectors_(most_vectors), assembly_(header.description) {}

void RecordsDecoder::add(ChunkType, std::span<const std::byte> payload, std::span<const ByteRange> missing) {
  const auto decoded = decode_records(payload, missing);
  const auto* patch = std::get_if<RecordsPatch>(&decoded);
  const bool fits = patch && assembly_.size() + patch->size() <= most_vectors_;
  if (!fits) {
    count_.full = count_.full || patch;
    ++count_.refused;
    return;
  }
  if (assembly_.add(*patch) > 0) ++count_.taken;
}

Geometry RecordsDecoder::geometry(GeometryBase base) const {
  const auto codes = assembly_.colors();
  if (kind_ == Kind::volume) {
    Volume volume(std::move(base));
    fill(volume);
    volume.classes.assign(codes.begin(), codes.end());
    return volume;
  }
  Splats splats(std::move(base));
  fill(splats);
  if (palette_.empty()) return splats;
  splats.colors.reserve(codes.size());
  for (const std::uint8_t code : codes) splats.colors.push_back(code < palette_.size() ? palette_[code] : splats.color);
  return splats;
}

void RecordsDecoder::fill(VectorArrays& vectors) const {
  vectors.positions.assign(assembly_.positions().begin(), assembly_.positions().end());
  vectors.normals.assign(assembly_.normals().begin(), assembly_.normals().end());
  vectors.weights = assembly_.conserved_weights();
  for (float& weight : vectors.weights) weight = std::max(weight, std::numeric_limits<float>::min());
}

}  // namespace gs::qnv
