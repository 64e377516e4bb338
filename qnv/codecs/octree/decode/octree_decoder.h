#pragma once

#include "qnv/codecs/lossless/decode/exact_surface.h"
#include "qnv/codecs/octree/decode/cluster_forest.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <span>

namespace gs::qnv {

/// Decoder of the octree payload. An exact mesh may follow the octree in the stream.
class OctreeDecoder final : public Decoder {
 public:
  OctreeDecoder(const StreamHeader& header, std::size_t most_vectors);

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) override;
  [[nodiscard]] DecodeCount count() const override;
  [[nodiscard]] std::size_t vectors() const override;
  [[nodiscard]] Geometry geometry(GeometryBase base) const override;
  [[nodiscard]] MeshProgress mesh() const override { return exact_.progress(); }

 private:
  Cube cube_;
  bool colored_;
  std::size_t most_vectors_;
  ClusterForest<Cluster> clusters_;
  ExactSurface exact_;  // exact mesh; replaces the octree when it is complete
};

}  // namespace gs::qnv
