#pragma once

#include "qnv/base/description.h"
#include "qnv/codecs/displaced/base_mesh.h"
#include "qnv/codecs/displaced/number_array.h"
#include "qnv/codecs/displaced/patches.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Number of layers, and log2 of the factor by which quantisation steps shrink from layer to layer.
inline constexpr int kLayers = 4, kLayerShift = 2;
inline constexpr int kMaxTriangles = 1 << 17;  // maximum for a base mesh
/// Quantisation steps of colours, on a scale of 0 to 255: for luma, and for both chromas.
inline constexpr int kLumaStep = 6, kChromaStep = 12;

/// Header of a stage: a base mesh and the parameters of its displacements. The stage replaces the previous one.
struct StageHeader {
  int depth = 4;  // 0 to kDeepestPatch: at this level, vertices are as dense as in the source
  int step_exponent = 10;  // 1 to 24; the step of layer k is size / 2^step_exponent / 4^k
  bool colored = false;
  bool beside = false;  // drawn in addition to the other stages; replaces none
  int clusters = 0;     // 0 to 255: number of clusters after which this stage replaces the earlier ones
  BaseMesh base;
};
[[nodiscard]] std::vector<std::byte> encode_stage(const StageHeader& header, std::span<const std::byte> base);
/// Decodes the header of a stage. Returns nullopt if the bytes are not a stage. Safe for untrusted bytes.
[[nodiscard]] std::optional<StageHeader> decode_stage(std::span<const std::byte> bytes);

/// Coordinates relative to the lower corner of the stream's box, in units of its longest edge. They make the precision
/// independent of the size and position of the source.
struct Frame {
  glm::vec3 lower{0};
  float size = 1;

  explicit Frame(const Box& box);
  [[nodiscard]] glm::vec3 inside(const glm::vec3& p) const { return (p - lower) / size; }
  [[nodiscard]] glm::vec3 outside(const glm::vec3& p) const { return lower + p * size; }
};

/// Header of a cluster.
struct ClusterHeader {
  enum class Kind : std::uint8_t { base = 0, displacement = 1, color = 2 };
  Kind kind = Kind::displacement;
  int stage = 0;                       // 0 to 15
  int level = 1;  // level of the new vertices; a cluster of level 1 also contains base vertices
  int layer = 0;                       // below kLayers
  std::uint32_t first = 0, count = 0;  // run of patches
  std::size_t bytes = 0;  // size of the encoded header
};
[[nodiscard]] std::vector<std::byte> encode_cluster_header(const ClusterHeader& header);
/// Decodes the header of a cluster. Returns nullopt if a field is out of range. Safe for untrusted bytes.
[[nodiscard]] std::optional<ClusterHeader> decode_cluster_header(std::span<const std::byte> payload);

/// Coded displacements of the vertices of one level. An array is empty if no numbers were received.
struct LevelNumbers {
  NumberArray normal, sideways;  // displacements along the normal and across a rim or crease, see ClusterCoder
};

/// Received part of one stage. Any subset of its clusters gives a surface without cracks: vertices without a received
/// number stay at their predicted position. One thread at a time.
class Surface {
 public:
  explicit Surface(StageHeader header);

  [[nodiscard]] const StageHeader& header() const { return header_; }
  /// Rejects clusters of deeper levels from now on.
  void limit_depth(int depth) { header_.depth = depth; }
  [[nodiscard]] const Patches& patches() const { return patches_; }
  [[nodiscard]] float step(int layer) const;
  /// Adds the numbers of a cluster. Returns false if the cluster is invalid, truncated or repeats numbers. Safe for
  /// untrusted bytes: memory and time are proportional to the number of bytes.
  bool add(const ClusterHeader& cluster, std::span<const std::byte> payload);
  /// Returns the number of clusters received. cluster_bytes() returns their total size.
  [[nodiscard]] std::size_t clusters() const { return clusters_; }
  [[nodiscard]] std::size_t cluster_bytes() const { return cluster_bytes_; }
  /// Returns the deepest level with received numbers; 0 if there are none.
  [[nodiscard]] int finest() const { return finest_; }

  /// Returns the numbers of a layer and level for writing. For encoders.
  [[nodiscard]] LevelNumbers& numbers(int layer, int level);
  /// Returns the received numbers of a layer and level; nullptr if none were received.
  [[nodiscard]] const LevelNumbers* find(int layer, int level) const;
  [[nodiscard]] std::array<NumberArray, 3>& colors(int level);

  /// Returns the patches cut along creases. Each of their vertices, called slots, has one normal.
  [[nodiscard]] const Patches& slots() const { return slots_; }
  /// Returns the directions in which base vertices at the positions `places` are displaced. If creases divide the
  /// triangles around a vertex, returns the mean of the normals of the parts.
  [[nodiscard]] std::vector<glm::vec3> base_normals(const std::vector<glm::vec3>& places) const;
  /// Returns the positions of the base vertices, before displacement. All positions of this class are relative to
  /// Frame.
  [[nodiscard]] std::vector<glm::vec3> base_positions() const;
  /// Returns the positions of the vertices of a level, with all received displacements.
  [[nodiscard]] std::vector<glm::vec3> positions(int level) const;
  /// Returns the colours of the vertices of a level; empty if no colours were received.
  [[nodiscard]] std::vector<Rgb8> vertex_colors(int level) const;
  /// Returns the vertex of every slot of a level.
  [[nodiscard]] std::vector<std::uint32_t> vertices_of_slots(int level) const;
  /// Returns the triangles of a level, as three slots each.
  [[nodiscard]] std::vector<std::uint32_t> triangles(int level) const;

 private:
  LevelNumbers& sparse(int layer, int level);
  std::array<NumberArray, 3>& sparse_colors(int level);
  bool add_run(const ClusterHeader& cluster);

  StageHeader header_;
  Patches patches_, slots_;
  bool lines_ = false;
  int finest_ = 0;
  std::size_t clusters_ = 0, cluster_bytes_ = 0;
  std::array<std::array<LevelNumbers, kDeepestPatch + 1>, kLayers> numbers_;
  std::array<std::array<NumberArray, 3>, kDeepestPatch + 1> colors_;
  // patches with received numbers, by layer and level; index kLayers is for colours
  std::array<std::array<std::vector<bool>, kDeepestPatch + 1>, kLayers + 1> taken_;
};

}  // namespace gs::qnv::displaced
