#pragma once

#include "qnv/codecs/octree/decode/cluster_forest.h"
#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/voxels/voxels.h"

#include <cstddef>
#include <span>

namespace gs::qnv {

/// Decoder of the volume payload. The first vectors of its geometry cover the volume evenly.
class VoxelsDecoder final : public Decoder {
 public:
  VoxelsDecoder(const StreamHeader& header, std::size_t most_vectors);

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) override;
  [[nodiscard]] DecodeCount count() const override { return clusters_.count(); }
  [[nodiscard]] std::size_t vectors() const override { return clusters_.vectors(); }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override;

 private:
  VoxelLattice lattice_;
  std::size_t most_vectors_;
  ClusterForest<VolumeCluster> clusters_;
};

}  // namespace gs::qnv
