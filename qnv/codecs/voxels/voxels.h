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

// Volume payload: the gradient vectors of a volume as an octree over its lattice, sent level by level in clusters that
// fit into a datagram. A voxel of the finest level is one vector. A coarser voxel holds the mean value, direction and
// magnitude of the vectors inside. A cluster divides a run of voxels of its parent cluster; until it is received, the
// parent's voxels are drawn. FORMAT.md, "Voxels payload", defines the bytes.

/// Index that marks a face without a neighbour in the cluster.
constexpr std::uint16_t kNoNeighbour = 0xffff;

/// Voxels of one cluster; every array has one entry per voxel.
struct VolumeVoxels {
  std::vector<std::uint16_t> x, y, z;  // cell coordinates at the cluster's level
  std::vector<std::int16_t> u, v;  // octahedral coordinates of the direction, in the axes of the lattice
  std::vector<std::uint8_t> value;  // class of the vectors, 0..255
  std::vector<std::uint8_t> magnitude;  // 0..kMaxMagnitude
  std::vector<std::uint8_t> activity;  // size class of last residual: bits 0..1 direction, 2..3 value
  /// Indices of the cluster's voxels that share a face: at -x, +x, -y, +y, -z, +z. Empty at the deepest level of the
  /// lattice, where no voxel is divided.
  std::vector<std::array<std::uint16_t, 6>> neighbours;

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t size);
};

/// Decoded cluster.
struct VolumeCluster {
  ClusterHeader header;
  VolumeVoxels voxels;  // voxels at level header.level + header.levels, in Morton order
  [[nodiscard]] int level() const { return header.level + header.levels; }
};

/// Reads only the header of a cluster. Safe for untrusted bytes.
[[nodiscard]] std::variant<ClusterHeader, PackedError> read_volume_cluster_header(std::span<const std::byte> payload);

/// Decodes a cluster. `parent` is the decoded parent, or nullptr for the root. Pure function; any thread. Safe for
/// untrusted bytes: the result has at most kMaxVoxels voxels, and time is proportional to their number. Checks the
/// final state of the entropy coder, which detects damage.
[[nodiscard]] std::variant<VolumeCluster, PackedError> decode_volume_cluster(std::span<const std::byte> payload,
                                                                             const VolumeCluster* parent,
                                                                             const VoxelLattice& lattice);

/// Appends the vectors of `count` voxels from index `first` on: position, unit gradient direction, magnitude, class.
/// The edge of a vector's Cell is VoxelLattice::reach of the level.
void append_vectors(const VolumeCluster& cluster, std::size_t first, std::size_t count, const VoxelLattice& lattice,
                    Volume& volume);

/// Vector of a volume on its lattice: the encoder's input.
struct LatticeVector {
  std::uint64_t key = 0;  // Morton code of the voxel
  glm::vec3 gradient{0};  // in the axes of the lattice (VoxelLattice::world_from_axes)
  float magnitude = 0;    // length of the gradient, > 0
  float value = 0;        // class, 0..255
};

struct VoxelSteps {
  int direction = 20;  // 1..64; the unit is 1/64 of the octahedron
  int value = 16;      // 1..255
  int magnitude = 6;  // 1..127; four steps make an octave
  /// Direction steps of the finest levels, finest level first. These levels cover most pixels of a picture.
  std::array<int, 3> last_directions{10, 10, 12};
};

struct VoxelsOptions {
  std::size_t max_bytes = 0;  // maximum total payload of all clusters; 0 means unlimited
  VoxelSteps steps{};
  std::vector<float> depth_of_class;  // optical depth of each class in the first view; if empty, all are equal
  unsigned threads = 0;
};

/// Encodes the vectors of a volume, most important cluster first. A parent always precedes its children. `finest` must
/// be sorted by keys, without duplicates. Deterministic. Returns an empty list if cancelled or if `finest` is empty.
[[nodiscard]] std::vector<EncodedCluster> encode_voxels(std::vector<LatticeVector> finest, const VoxelLattice& lattice,
                                                        const VoxelsOptions& options, Progress* progress = nullptr);

}  // namespace gs::qnv
