#pragma once

#include "qnv/codecs/records/decode/records_assembly.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <span>
#include <vector>

namespace gs::qnv {

/// Decoder of the records payload.
class RecordsDecoder final : public Decoder {
 public:
  RecordsDecoder(const StreamHeader& header, std::size_t most_vectors);

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) override;
  [[nodiscard]] DecodeCount count() const override { return count_; }
  [[nodiscard]] std::size_t vectors() const override { return assembly_.size(); }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override;

 private:
  void fill(VectorArrays& vectors) const;

  Kind kind_;
  std::vector<Rgb8> palette_;
  std::size_t most_vectors_;
  DecodeCount count_;
  mutable RecordsAssembly assembly_;  // gets received chunks when its vectors are requested
};

}  // namespace gs::qnv
