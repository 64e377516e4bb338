#pragma once

#include "qnv/base/geometry.h"
#include "qnv/base/voxels.h"

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

// The packed payload: an octree over the surface, sent level by level in clusters that fit into a datagram. Every voxel
// holds one plane, an octahedral normal and a distance; its splat follows from them and the level. A cluster divides a
// run of voxels of its parent cluster. Until it is received, the parent's voxels are drawn. FORMAT.md, "Packed
// payload", defines the bytes.

/// Octahedral coordinates are in -kOctahedral..kOctahedral; |x| + |y| + |z| of a normal is kOctahedral too.
constexpr int kOctahedral = 1024;
/// Plane distances are in 1/64 of the voxel's edge times the 1-norm of the unit normal: -32..32.
constexpr int kOffsetUnits = 64;
/// Maximum number of voxels of a cluster; larger ones are rejected.
constexpr std::size_t kMaxVoxels = 65535;
constexpr std::uint32_t kNoParent = 0xffffffff;

/// Voxels of one cluster; every array has one entry per voxel.
struct PackedVoxels {
  std::vector<std::uint16_t> x, y, z;      // cell at its level
  std::vector<std::int16_t> u, v;          // octahedral normal
  std::vector<std::int8_t> offset;         // of the plane from the voxel's centre, along the normal
  std::vector<std::uint8_t> state;         // bits 0..1: size of the last residual; bit 2: both sides of a thin sheet
  std::vector<std::int16_t> luma, co, cg;  // colour in YCoCg; may be empty

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t size, bool colored);
};
constexpr std::uint8_t kActivity = 3, kDouble = 4;

/// Position of a cluster in the octree, from its first bytes.
struct ClusterHeader {
  std::uint32_t id = 0, parent = kNoParent;
  std::uint16_t first = 0, count = 1;  // run of the parent's voxels that is divided
  std::uint8_t level = 0;              // of the run
  std::uint8_t levels = 1;             // number of divisions
};

/// Decoded cluster.
struct Cluster {
  ClusterHeader header;
  PackedVoxels voxels;  // at level header.level + header.levels, in Morton order of the run
  [[nodiscard]] int level() const { return header.level + header.levels; }
};

/// Reason for rejecting a cluster.
struct PackedError {
  std::string message;
};

/// Reads only the header. Safe for untrusted bytes.
[[nodiscard]] std::variant<ClusterHeader, PackedError> read_cluster_header(std::span<const std::byte> payload);

/// Decodes a cluster against its parent (nullptr if it has none). Pure; safe from any thread and for untrusted bytes.
/// Produces at most kMaxVoxels voxels, in time proportional to them. Checks the final state of the entropy coder,
/// which detects most damage that a checksum missed.
[[nodiscard]] std::variant<Cluster, PackedError> decode_cluster(std::span<const std::byte> payload,
                                                                const Cluster* parent);

/// Returns the number of splats of voxels `first` to `first + count` - 1; a thin sheet has two.
[[nodiscard]] std::uint32_t discs_of(const PackedVoxels& voxels, std::size_t first, std::size_t count);
/// Appends the splats of voxels `first` to `first + count` - 1: position on the plane, unit normal, area
/// of the plane inside the voxel. A thin sheet gives two splats back to back. Fills `colors` if the voxels have them.
void append_discs(const Cluster& cluster, std::size_t first, std::size_t count, const Cube& cube, Splats& splats);

struct PackedOptions {
  std::size_t vectors = 0;    // approximate number of splats at full detail
  std::size_t max_bytes = 0;  // total payload of all clusters; 0 means unlimited
  int normal_shift = 6;       // 1..10; normals are coded in steps of 2^normal_shift / 1024 of the octahedron
  int offset_shift = 2;       // 0..6; distances in steps of 2^offset_shift / 64
  int color_shift = 3;        // 0..7; luma in steps of 2^color_shift, chroma of twice that
  bool compact = false;       // use these steps at every level; else deep levels use half, if that pays
  bool colored = false;
  unsigned threads = 0;
};

struct EncodedCluster {
  std::vector<std::byte> payload;
  ClusterHeader header;
  Box box;  // of its voxels
  std::uint32_t voxels = 0;
  std::uint32_t divided = 0;  // number of parent voxels that they replace
  float level_edge = 0;       // edge of its voxels, units of the source
};

/// Encodes the voxels of one level and of all levels above it, most important cluster first. A parent always precedes
/// its children. Deterministic. Returns an empty list if cancelled.
[[nodiscard]] std::vector<EncodedCluster> encode_packed(std::vector<Voxel> finest, int level, const Cube& cube,
                                                        const PackedOptions& options, Progress* progress = nullptr);

}  // namespace gs::qnv
