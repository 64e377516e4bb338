#pragma once

#include "qnv/base/cloud.h"
#include "qnv/packed/packed.h"
#include "qnv/stream/voxel_lattice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv {

// The voxels payload: the gradient vectors of a volume as an octree over its lattice, sent level by level in clusters
// that fit into a datagram. A voxel of the finest level is one vector; a coarser one stands for those in it: their mean
// value, direction and magnitude. A cluster divides a run of the voxels of another cluster, its parent; until it
// arrives the parent's voxels are drawn. The bytes are defined in FORMAT.md, "Voxels payload".

/// No voxel of the cluster.
constexpr std::uint16_t kNoNeighbour = 0xffff;

/// Voxels of one cluster; every array has an entry a voxel.
struct VolumeVoxels {
  std::vector<std::uint16_t> x, y, z;   // cell at its level
  std::vector<std::int16_t> u, v;       // octahedral direction along the lattice's axes
  std::vector<std::uint8_t> value;      // class
  std::vector<std::uint8_t> magnitude;  // 0..kMostMagnitude
  std::vector<std::uint8_t> activity;  // size of the last residual, 0..3: bits 0..1 of the direction, 2..3 of the value
  /// The voxels of the cluster that share a face: below along x, above along x, and so on. Empty at the lattice's
  /// depth, where nothing is divided any more.
  std::vector<std::array<std::uint16_t, 6>> neighbours;

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t size);
};

/// A cluster, decoded.
struct VolumeCluster {
  ClusterHeader header;
  VolumeVoxels voxels;  // at level header.level + header.levels, in Morton order
  [[nodiscard]] int level() const { return header.level + header.levels; }
};

/// Reads only the header. Safe for untrusted bytes.
[[nodiscard]] std::variant<ClusterHeader, PackedError> read_volume_cluster_header(std::span<const std::byte> payload);

/// Decodes a cluster against its parent (null for one without). Pure; any thread; safe for untrusted bytes: at most
/// kMostVoxels voxels, time proportional to them. Checks that the entropy coder comes out even.
[[nodiscard]] std::variant<VolumeCluster, PackedError> decode_volume_cluster(std::span<const std::byte> payload,
                                                                             const VolumeCluster* parent,
                                                                             const VoxelLattice& lattice);

/// Appends the vectors that voxels `first` to `first + count` stand for: position, unit gradient direction, magnitude,
/// class; the edge of a cell is VoxelLattice::reach of its level.
void append_vectors(const VolumeCluster& cluster, std::size_t first, std::size_t count, const VoxelLattice& lattice,
                    Cloud& cloud);

/// One vector of a volume on its lattice, for the encoder.
struct LatticeVector {
  std::uint64_t key = 0;  // Morton code of its voxel
  glm::vec3 gradient{0};  // its parts along the lattice's axes (VoxelLattice::world_from_axes)
  float magnitude = 0;    // its length, > 0
  float value = 0;        // class, 0..255
};

struct VoxelSteps {
  int direction = 20;  // 1..64: in 1/64 of the octahedron
  int value = 16;      // 1..255
  int magnitude = 6;   // 1..127: four are an octave
  /// Directions of the finest levels, the last one first, of which most pixels of a picture are.
  std::array<int, 3> last_directions{10, 10, 12};
};

struct VoxelsOptions {
  std::size_t max_bytes = 0;  // payload bytes of all clusters; 0: no limit
  VoxelSteps steps{};
  std::vector<float> depth_of_class;  // optical depth by class of what is drawn first; empty: all are alike
  unsigned threads = 0;
};

/// Encodes the vectors of a volume, most important cluster first; a parent always stands before its children. `finest`
/// is sorted by key, each once. Deterministic. Empty when cancelled or there are no vectors.
[[nodiscard]] std::vector<EncodedCluster> encode_voxels(std::vector<LatticeVector> finest, const VoxelLattice& lattice,
                                                        const VoxelsOptions& options, Progress* progress = nullptr);

}  // namespace gs::qnv
