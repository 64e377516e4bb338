#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/octree/packed.h"
#include "qnv/container/voxel_lattice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv {

// The voxels payload: the gradient vectors of a volume as an octree over its lattice, sent level by level in clusters
// that fit into a datagram. A voxel of the finest level is one vector; a coarser voxel holds the mean value, direction
// and magnitude of the vectors inside. A cluster divides a run of voxels of its parent cluster. Until it is received,
// the parent's voxels are drawn. FORMAT.md, "Voxels payload", defines the bytes.

/// Marks a face without a neighbour in the cluster.
constexpr std::uint16_t kNoNeighbour = 0xffff;

/// Voxels of one cluster; every array has one entry per voxel.
struct VolumeVoxels {
  std::vector<std::uint16_t> x, y, z;   // cell at its level
  std::vector<std::int16_t> u, v;       // octahedral direction along the lattice's axes
  std::vector<std::uint8_t> value;      // class
  std::vector<std::uint8_t> magnitude;  // 0..kMaxMagnitude
  std::vector<std::uint8_t> activity;   // size of the last residual, 0..3: bits 0..1 for direction, 2..3 for value
  /// Voxels of the cluster that share a face: below along x, above along x, then y and z. Empty at the lattice's depth,
  /// which is never divided.
  std::vector<std::array<std::uint16_t, 6>> neighbours;

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t size);
};

/// Decoded cluster.
struct VolumeCluster {
  ClusterHeader header;
  VolumeVoxels voxels;  // at level header.level + header.levels, in Morton order
  [[nodiscard]] int level() const { return header.level + header.levels; }
};

/// Reads only the header. Safe for untrusted bytes.
[[nodiscard]] std::variant<ClusterHeader, PackedError> read_volume_cluster_header(std::span<const std::byte> payload);

/// Decodes a cluster against its parent (nullptr if it has none). Pure; safe from any thread and for untrusted bytes.
/// Produces at most kMaxVoxels voxels, in time proportional to them. Checks the final state of the entropy coder.
[[nodiscard]] std::variant<VolumeCluster, PackedError> decode_volume_cluster(std::span<const std::byte> payload,
                                                                             const VolumeCluster* parent,
                                                                             const VoxelLattice& lattice);

/// Appends the vectors of voxels `first` to `first + count` - 1: position, unit gradient direction, magnitude, class.
/// The edge of a Cell is VoxelLattice::reach of the level.
void append_vectors(const VolumeCluster& cluster, std::size_t first, std::size_t count, const VoxelLattice& lattice,
                    Volume& volume);

/// Vector of a volume on its lattice, for the encoder.
struct LatticeVector {
  std::uint64_t key = 0;  // Morton code of the voxel
  glm::vec3 gradient{0};  // components along the lattice's axes (VoxelLattice::world_from_axes)
  float magnitude = 0;    // length of the gradient, > 0
  float value = 0;        // class, 0..255
};

struct VoxelSteps {
  int direction = 20;  // 1..64; unit 1/64 of the octahedron
  int value = 16;      // 1..255
  int magnitude = 6;   // 1..127; four steps are an octave
  /// Direction steps of the finest levels, deepest level first. These levels cover most pixels of a picture.
  std::array<int, 3> last_directions{10, 10, 12};
};

struct VoxelsOptions {
  std::size_t max_bytes = 0;  // total payload of all clusters; 0 means unlimited
  VoxelSteps steps{};
  std::vector<float> depth_of_class;  // optical depth of each class in the first view; if empty, all classes are equal
  unsigned threads = 0;
};

/// Encodes the vectors of a volume, most important cluster first. A parent always precedes its children. `finest` is
/// sorted by unique keys. Deterministic. Returns an empty list if cancelled or without vectors.
[[nodiscard]] std::vector<EncodedCluster> encode_voxels(std::vector<LatticeVector> finest, const VoxelLattice& lattice,
                                                        const VoxelsOptions& options, Progress* progress = nullptr);

}  // namespace gs::qnv
