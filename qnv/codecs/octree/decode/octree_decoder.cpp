#include "qnv/codecs/octree/decode/octree_decoder.h"

#include <cstdint>
#include <utility>

namespace gs::qnv {
namespace {

std::uint32_t vectors_of(const Cluster& cluster, std::size_t first, std::size_t count) {
  return discs_of(cluster.voxels, first, count);
}

}  // namespace

OctreeDecoder::OctreeDecoder(const StreamHeader& header, std::size_t most_vectors)
    : cube_(header.cube),
      colored_(header.colored),
      most_vectors_(most_vectors),
      clusters_({read_cluster_header, vectors_of}),
      exact_(header.description.box, most_vectors) {}

void OctreeDecoder::add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) {
  if (type != ChunkType::packed) return exact_.add(type, payload);
  clusters_.add(payload, most_vectors_,
                [](std::span<const std::byte> bytes, const Cluster* parent) { return decode_cluster(bytes, parent); });
}

DecodeCount OctreeDecoder::count() const {
  DecodeCount count = clusters_.count();
  return count += exact_.count();
}

std::size_t OctreeDecoder::vectors() const { return exact_.whole() ? exact_.vectors() : clusters_.vectors(); }

Geometry OctreeDecoder::geometry(GeometryBase base) const {
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

}  // namespace gs::qnv
