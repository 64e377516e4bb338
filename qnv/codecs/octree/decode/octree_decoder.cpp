#include "qnv/codecs/lossless/decode/exact_surface.h"
#include "qnv/codecs/octree/decode/cluster_forest.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace gs::qnv {
namespace {

std::uint32_t vectors_of(const Cluster& cluster, std::size_t first, std::size_t count) {
  return discs_of(cluster.voxels, first, count);
}

/// Decoder of the octree payload. An exact mesh may follow the octree in the stream.
class OctreeDecoder final : public Decoder {
 public:
  OctreeDecoder(const StreamHeader& header, std::size_t most_vectors)
      : cube_(header.cube),
        colored_(header.colored),
        most_vectors_(most_vectors),
        clusters_({read_cluster_header, vectors_of}),
        exact_(header.description.box, most_vectors) {}

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) override {
    if (type != ChunkType::packed) return exact_.add(type, payload);
    clusters_.add(payload, most_vectors_, [](std::span<const std::byte> bytes, const Cluster* parent) {
      return decode_cluster(bytes, parent);
    });
  }
  [[nodiscard]] DecodeCount count() const override {
    DecodeCount count = clusters_.count();
    return count += exact_.count();
  }
  [[nodiscard]] std::size_t vectors() const override { return exact_.whole() ? exact_.vectors() : clusters_.vectors(); }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    if (exact_.whole()) {
      IndexedMesh mesh(std::move(base));
      exact_.append(mesh, colored_);
      return mesh;
    }
    Splats splats(std::move(base));
    clusters_.visit_shown([&](const Cluster& cluster, std::size_t first, std::size_t count) {
      append_discs(cluster, first, count, cube_, splats);
    });
    return splats;
  }
  [[nodiscard]] MeshProgress mesh() const override { return exact_.progress(); }

 private:
  Cube cube_;
  bool colored_;
  std::size_t most_vectors_;
  ClusterForest<Cluster> clusters_;
  ExactSurface exact_;  // exact mesh; replaces the octree when it is complete
};

}  // namespace

std::unique_ptr<Decoder> make_octree_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<OctreeDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
