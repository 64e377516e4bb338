#pragma once

#include "qnv/codecs/displaced/decode/surface_stages.h"
#include "qnv/codecs/lossless/decode/exact_surface.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

/// Decoder of the displaced payload, which an exact mesh may follow.
class DisplacedDecoder final : public Decoder {
 public:
  DisplacedDecoder(const StreamHeader& header, std::size_t most_vectors);

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) override;
  [[nodiscard]] DecodeCount count() const override;
  [[nodiscard]] std::size_t vectors() const override;
  void append(Cloud& cloud) const override;
  [[nodiscard]] std::shared_ptr<const SurfacePatches> patches() override;
  [[nodiscard]] bool has_arrays() const override { return exact_.whole() || !covered().empty(); }
  [[nodiscard]] MeshProgress mesh() const override { return exact_.progress(); }

 private:
  /// Returns the patches that received triangles cover, if a part of the mesh is shown; else an empty list.
  [[nodiscard]] std::vector<bool> covered() const;

  bool colored_;
  std::size_t most_vectors_;
  SurfaceStages stages_;
  ExactSurface exact_;  // replaces the stages once received
};

}  // namespace gs::qnv
