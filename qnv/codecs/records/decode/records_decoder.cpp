#include "qnv/codecs/records/decode/records_decoder.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <variant>

namespace gs::qnv {

RecordsDecoder::RecordsDecoder(const StreamHeader& header, std::size_t most_vectors)
    : kind_(header.description.kind),
      palette_(header.palette),
      most_vectors_(most_vectors),
      assembly_(header.description) {}

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

void RecordsDecoder::append(Cloud& cloud) const {
  if (assembly_.size() == 0) return;
  cloud.positions.assign(assembly_.positions().begin(), assembly_.positions().end());
  cloud.normals.assign(assembly_.normals().begin(), assembly_.normals().end());
  cloud.weights = assembly_.conserved_weights();
  for (float& weight : cloud.weights) weight = std::max(weight, std::numeric_limits<float>::min());
  const auto codes = assembly_.colors();
  if (kind_ == Kind::volume) {
    cloud.classes.assign(codes.begin(), codes.end());
  } else if (!palette_.empty()) {
    cloud.colors.reserve(codes.size());
    for (const std::uint8_t code : codes) cloud.colors.push_back(code < palette_.size() ? palette_[code] : cloud.color);
  }
}

}  // namespace gs::qnv
