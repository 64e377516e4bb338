#pragma once

#include "qnv/base/geometry.h"
#include "qnv/base/voxels.h"

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

// Octree payload: an octree over the surface, sent level by level in clusters that fit into a datagram. Every voxel
// holds one plane, stored as an octahedral normal and a distance. The plane and the level determine the voxel's splat.
// A cluster divides a run of voxels of its parent cluster; until it is received, the parent's voxels are drawn.
// FORMAT.md, "Packed payload", defines the bytes.

/// Maximum octahedral coordinate; the minimum is -kOctahedral. The components of a normal satisfy |x| + |y| + |z| =
/// kOctahedral.
constexpr int kOctahedral = 1024;
/// Units of plane distances per voxel edge: a distance is in 1/64 of the edge times the 1-norm of the unit normal,
/// -32..32.
constexpr int kOffsetUnits = 64;
/// Maximum number of voxels of a cluster. Larger clusters are rejected.
constexpr std::size_t kMaxVoxels = 65535;
constexpr std::uint32_t kNoParent = 0xffffffff;

/// Voxels of one cluster; every array has one entry per voxel.
struct PackedVoxels {
  std::vector<std::uint16_t> x, y, z;  // cell coordinates at the cluster's level
  std::vector<std::int16_t> u, v;          // octahedral normal
  std::vector<std::int8_t> offset;  // distance of the plane from the voxel's centre, along the normal
  std::vector<std::uint8_t> state;  // bits 0..1: size class of last residual; bit 2: two-sided sheet
  std::vector<std::int16_t> luma, co, cg;  // colour in YCoCg; may be empty

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t size, bool colored);
};
constexpr std::uint8_t kActivity = 3, kDouble = 4;

/// Header of a cluster: its position in the octree.
struct ClusterHeader {
  std::uint32_t id = 0, parent = kNoParent;
  std::uint16_t first = 0, count = 1;  // run of the parent's voxels that the cluster divides
  std::uint8_t level = 0;  // level of the run
  std::uint8_t levels = 1;  // number of levels by which the run is divided
};

/// Decoded cluster.
struct Cluster {
  ClusterHeader header;
  PackedVoxels voxels;  // voxels at level header.level + header.levels, in Morton order of the run
  [[nodiscard]] int level() const { return header.level + header.levels; }
};

/// Reason for rejecting a cluster.
struct PackedError {
  std::string message;
};

/// Reads only the header of a cluster. Safe for untrusted bytes.
[[nodiscard]] std::variant<ClusterHeader, PackedError> read_cluster_header(std::span<const std::byte> payload);

/// Decodes a cluster. `parent` is the decoded parent, or nullptr for the root. Pure function; any thread. Safe for
/// untrusted bytes: the result has at most kMaxVoxels voxels, and time is proportional to their number. Checks the
/// final state of the entropy coder, which detects most damage that a checksum missed.
[[nodiscard]] std::variant<Cluster, PackedError> decode_cluster(std::span<const std::byte> payload,
                                                                const Cluster* parent);

/// Returns the number of splats of `count` voxels from index `first` on. A thin sheet has two splats.
[[nodiscard]] std::uint32_t discs_of(const PackedVoxels& voxels, std::size_t first, std::size_t count);
/// Appends the splats of voxels `first` to `first + count` - 1: position on the plane, unit normal, area
/// of the plane inside the voxel. A thin sheet gives two splats back to back. Fills `colors` if the voxels have them.
void append_discs(const Cluster& cluster, std::size_t first, std::size_t count, const Cube& cube, Splats& splats);

struct PackedOptions {
  std::size_t vectors = 0;    // approximate number of splats at full detail
  std::size_t max_bytes = 0;  // maximum total payload of all clusters; 0 means unlimited
  int normal_shift = 6;  // 1..10; normals have steps of 2^normal_shift / 1024 of the octahedron
  int offset_shift = 2;  // 0..6; plane distances have steps of 2^offset_shift / 64
  int color_shift = 3;  // 0..7; luma has steps of 2^color_shift, chroma twice that
  bool compact = false;  // uses these steps at every level; otherwise deep levels use half, if that pays
  bool colored = false;
  unsigned threads = 0;
};

struct EncodedCluster {
  std::vector<std::byte> payload;
  ClusterHeader header;
  Box box;  // bounds of its voxels
  std::uint32_t voxels = 0;
  std::uint32_t divided = 0;  // number of voxels of the parent that it replaces
  float level_edge = 0;       // edge of its voxels, units of the source
};

/// Encodes the voxels of one level and of all coarser levels, most important cluster first. A parent always precedes
/// its children. Deterministic. Returns an empty list if cancelled.
[[nodiscard]] std::vector<EncodedCluster> encode_packed(std::vector<Voxel> finest, int level, const Cube& cube,
                                                        const PackedOptions& options, Progress* progress = nullptr);

}  // namespace gs::qnv
