#include "qnv/codecs/octree/decode/cluster_forest.h"
#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/voxels/voxels.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

std::uint32_t vectors_of(const VolumeCluster&, std::size_t, std::size_t count) {
  return static_cast<std::uint32_t>(count);
}

// Returns `i` with its lowest `bits` bits in reverse order.
std::uint64_t reversed(std::uint64_t i, int bits) {
  std::uint64_t out = 0;
  for (int bit = 0; bit < bits; ++bit) out |= (i >> bit & 1) << (bits - 1 - bit);
  return out;
}

template <class T>
void permute(std::span<const std::uint32_t> order, std::vector<T>& values) {
  std::vector<T> moved(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) moved[i] = values[order[i]];
  values = std::move(moved);
}

// Reorders vectors from their spatial order by bit-reversed indices. Then every prefix covers the volume evenly.
void spread(Volume& volume) {
  const std::size_t size = volume.size();
  const auto bits = static_cast<int>(std::bit_width(size));
  std::vector<std::uint32_t> order;
  order.reserve(size);
  for (std::uint64_t i = 0; order.size() < size; ++i)
    if (const std::uint64_t at = reversed(i, bits); at < size) order.push_back(static_cast<std::uint32_t>(at));
  permute(order, volume.positions);
  permute(order, volume.normals);
  permute(order, volume.weights);
  permute(order, volume.classes);
  permute(order, volume.cells);
}

/// Decoder of the volume payload. The first vectors of its geometry cover the volume evenly.
class VoxelsDecoder final : public Decoder {
 public:
  VoxelsDecoder(const StreamHeader& header, std::size_t most_vectors)
      : lattice_(header.lattice), most_vectors_(most_vectors), clusters_({read_volume_cluster_header, vectors_of}) {}

  void add(ChunkType, std::span<const std::byte> payload, std::span<const ByteRange>) override {
    clusters_.add(payload, most_vectors_, [this](std::span<const std::byte> bytes, const VolumeCluster* parent) {
      return decode_volume_cluster(bytes, parent, lattice_);
    });
  }
  [[nodiscard]] DecodeCount count() const override { return clusters_.count(); }
  [[nodiscard]] std::size_t vectors() const override { return clusters_.vectors(); }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    Volume volume(std::move(base));
    clusters_.visit_shown([&](const VolumeCluster& cluster, std::size_t first, std::size_t count) {
      append_vectors(cluster, first, count, lattice_, volume);
    });
    spread(volume);
    return volume;
  }

 private:
  VoxelLattice lattice_;
  std::size_t most_vectors_;
  ClusterForest<VolumeCluster> clusters_;
};

}  // namespace

std::unique_ptr<Decoder> make_voxels_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<VoxelsDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
