#include "qnv/codecs/records/decode/records_assembly.h"
#include "qnv/codecs/shared/decoder.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

/// Decoder of the records payload.
class RecordsDecoder final : public Decoder {
 public:
  RecordsDecoder(const StreamHeader& header, std::size_t most_vectors)
      : kind_(header.kind), palette_(header.palette), most_vectors_(most_vectors), assembly_(header.description) {}

  void add(ChunkType, std::span<const std::byte> payload, std::span<const ByteRange> missing) override {
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
  [[nodiscard]] DecodeCount count() const override { return count_; }
  [[nodiscard]] std::size_t vectors() const override { return assembly_.size(); }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
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
    for (const std::uint8_t code : codes)
      splats.colors.push_back(code < palette_.size() ? palette_[code] : splats.color);
    return splats;
  }

 private:
  void fill(VectorArrays& vectors) const {
    vectors.positions.assign(assembly_.positions().begin(), assembly_.positions().end());
    vectors.normals.assign(assembly_.normals().begin(), assembly_.normals().end());
    vectors.weights = assembly_.conserved_weights();
    for (float& weight : vectors.weights) weight = std::max(weight, std::numeric_limits<float>::min());
  }

  Kind kind_;
  std::vector<Rgb8> palette_;
  std::size_t most_vectors_;
  DecodeCount count_;
  mutable RecordsAssembly assembly_;  // gets received chunks when its vectors are requested
};

}  // namespace

std::unique_ptr<Decoder> make_records_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<RecordsDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
