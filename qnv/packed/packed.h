#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/voxels.h"

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

// The packed payload: an octree over the surface, sent level by level in clusters that fit into a datagram. Every
// voxel holds one plane: an octahedral normal and a distance, so that its disc follows from its level. A cluster
// divides a run of the voxels of another cluster, its parent; until it arrives the parent's voxels are drawn. The bytes
// are defined in FORMAT.md, "Packed payload".

/// Octahedral coordinates run from -kOctahedral to kOctahedral; |x| + |y| + |z| of a normal is kOctahedral too.
constexpr int kOctahedral = 1024;
/// Distances of planes are in 1/64 of the voxel's edge times the 1-norm of the unit normal: -32..32.
constexpr int kOffsetUnits = 64;
/// No cluster has more voxels than this, whatever its bytes say.
constexpr std::size_t kMostVoxels = 65535;
constexpr std::uint32_t kNoParent = 0xffffffff;

/// Voxels of one cluster; every array has an entry a voxel.
struct PackedVoxels {
  std::vector<std::uint16_t> x, y, z;      // cell at its level
  std::vector<std::int16_t> u, v;          // octahedral normal
  std::vector<std::int8_t> offset;         // of the plane from the centre, towards the normal
  std::vector<std::uint8_t> state;         // bits 0..1: size of the last difference, 2: both sides of a thin sheet
  std::vector<std::int16_t> luma, co, cg;  // YCoCg of the colour, or empty

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t size, bool colored);
};
constexpr std::uint8_t kActivity = 3, kDouble = 4;

/// What the first bytes of a cluster say.
struct ClusterHeader {
  std::uint32_t id = 0, parent = kNoParent;
  std::uint16_t first = 0, count = 1;  // the run of the parent's voxels that is divided
  std::uint8_t level = 0;              // of the run
  std::uint8_t levels = 1;             // how often it is divided
};

/// A cluster, decoded.
struct Cluster {
  ClusterHeader header;
  PackedVoxels voxels;  // at level header.level + header.levels, in Morton order of the run
  [[nodiscard]] int level() const { return header.level + header.levels; }
};

/// Why a cluster was refused.
struct PackedError {
  std::string message;
};

/// Reads only the header. Safe for untrusted bytes.
[[nodiscard]] std::variant<ClusterHeader, PackedError> read_cluster_header(std::span<const std::byte> payload);

/// Decodes a cluster against its parent (null for one without). Pure; any thread; safe for untrusted bytes: at most
/// kMostVoxels voxels, time proportional to them. Checks that the entropy coder comes out even, which finds most damage
/// that a checksum did not.
[[nodiscard]] std::variant<Cluster, PackedError> decode_cluster(std::span<const std::byte> payload,
                                                                const Cluster* parent);

/// How many discs voxels `first` to `first + count` are: two for a thin sheet.
[[nodiscard]] std::uint32_t discs_of(const PackedVoxels& voxels, std::size_t first, std::size_t count);
/// Appends the discs of voxels `first` to `first + count` to a cloud: centre on the plane, unit normal, area of the
/// plane inside the voxel; two discs back to back for a thin sheet. Fills `colors` when the voxels have them.
void append_discs(const Cluster& cluster, std::size_t first, std::size_t count, const Cube& cube, Cloud& cloud);

struct PackedOptions {
  std::size_t vectors = 0;    // about this many discs at full detail
  std::size_t max_bytes = 0;  // payload bytes of all clusters; 0: no limit
  int normal_shift = 6;       // 1..10; normals are coded in steps of 2^normal_shift / 1024 of the octahedron
  int offset_shift = 2;       // 0..6; distances in steps of 2^offset_shift / 64
  int color_shift = 3;        // 0..7; luma in steps of 2^color_shift, chroma of twice that
  bool compact = false;       // these steps at every level; else they are halved deep down, where that pays
  bool colored = false;
  unsigned threads = 0;
};

struct EncodedCluster {
  std::vector<std::byte> payload;
  ClusterHeader header;
  Box box;  // of its voxels
  std::uint32_t voxels = 0;
  std::uint32_t divided = 0;  // how many voxels of the parent they replace
  float level_edge = 0;       // edge of its voxels, units of the source
};

/// Encodes the voxels of one level and all above it, most important cluster first; a parent always stands before its
/// children. Deterministic. Stops early when cancelled: then empty.
[[nodiscard]] std::vector<EncodedCluster> encode_packed(std::vector<Voxel> finest, int level, const Cube& cube,
                                                        const PackedOptions& options, Progress* progress = nullptr);

}  // namespace gs::qnv
