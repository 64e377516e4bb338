#pragma once

#include "qnv/codecs/lossless/decode/exact_surface.h"
#include "qnv/codecs/lossless/decode/shaded_mesh.h"
#include "qnv/codecs/progressive/progressive.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <optional>
#include <span>

namespace gs::qnv {

/// Decoder of the progressive payload. An exact mesh may follow in the stream.
class ProgressiveDecoder final : public Decoder {
 public:
  ProgressiveDecoder(const StreamHeader& header, std::size_t most_vectors);

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) override;
  [[nodiscard]] DecodeCount count() const override;
  [[nodiscard]] std::size_t vectors() const override;
  [[nodiscard]] Geometry geometry(GeometryBase base) const override;
  [[nodiscard]] MeshProgress mesh() const override;

 private:
  /// Returns the mesh received so far; recomputes it after changes.
  [[nodiscard]] const IndexedMesh& shown() const;

  bool colored_;
  Box box_;
  progressive::ProgressiveMesh mesh_;
  DecodeCount count_;
  mutable std::optional<IndexedMesh> shown_;
  ExactSurface exact_;  // exact mesh; replaces the growing mesh when it is complete
};

}  // namespace gs::qnv
