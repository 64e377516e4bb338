#pragma once

#include "qnv/codecs/displaced/decode/surface_stages.h"
#include "qnv/codecs/lossless/decode/exact_surface.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <span>
#include <vector>

namespace gs::qnv {

/// Decoder of the displaced payload. An exact mesh may follow the stages in the stream.
class DisplacedDecoder final : public Decoder {
 public:
  DisplacedDecoder(const StreamHeader& header, std::size_t most_vectors);

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) override;
  [[nodiscard]] DecodeCount count() const override;
  [[nodiscard]] std::size_t vectors() const override;
  [[nodiscard]] Geometry geometry(GeometryBase base) const override;
  /// Returns patches, unless a part of the exact mesh is shown.
  [[nodiscard]] Geometry geometry_to_draw(GeometryBase base) override;
  [[nodiscard]] MeshProgress mesh() const override { return exact_.progress(); }

 private:
  /// Returns one flag per patch: true if received triangles of the exact mesh cover the patch. Returns an empty list if
  /// no part of the exact mesh is drawn.
  [[nodiscard]] std::vector<bool> covered() const;

  bool colored_;
  std::size_t most_vectors_;
  SurfaceStages stages_;
  ExactSurface exact_;  // exact mesh; replaces the stages when it is complete
};

}  // namespace gs::qnv
