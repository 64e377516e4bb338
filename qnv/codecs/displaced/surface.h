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

/// Number of layers, and log2 of the factor by which steps shrink per layer.
inline constexpr int kLayers = 4, kLayerShift = 2;
inline constexpr int kMaxTriangles = 1 << 17;  // of a base
/// Steps of colours, of 255: luma, and both chromas.
inline constexpr int kLumaStep = 6, kChromaStep = 12;

/// Stage of a stream: a base mesh and the parameters of its displacements. It replaces the previous stage.
struct StageHeader {
  int depth = 4;           // 0 to kDeepestPatch: level at which vertices are as dense as the source's
  int step_exponent = 10;  // 1 to 24: the step of layer 0 is size / 2^step_exponent; that of layer k is 4^k times
                           // smaller
  bool colored = false;
  bool beside = false;  // shown in addition to the other stages, without replacing any
  int clusters = 0;     // 0 to 255: number of clusters after which this stage replaces the earlier ones
  BaseMesh base;
};
[[nodiscard]] std::vector<std::byte> encode_stage(const StageHeader& header, std::span<const std::byte> base);
/// Returns nullopt if the bytes are not a stage. Safe for untrusted bytes.
[[nodiscard]] std::optional<StageHeader> decode_stage(std::span<const std::byte> bytes);

/// Coordinates relative to the lower corner of the stream's box, in units of its longest edge. Makes the precision
/// independent of the size and position of the source.
struct Frame {
  glm::vec3 lower{0};
  float size = 1;

  explicit Frame(const Box& box);
  [[nodiscard]] glm::vec3 inside(const glm::vec3& p) const { return (p - lower) / size; }
  [[nodiscard]] glm::vec3 outside(const glm::vec3& p) const { return lower + p * size; }
};

/// Content of a cluster.
struct ClusterHeader {
  enum class Kind : std::uint8_t { base = 0, displacement = 1, color = 2 };
  Kind kind = Kind::displacement;
  int stage = 0;                       // 0 to 15
  int level = 1;                       // of the new vertices; level 1 also has those of the base
  int layer = 0;                       // below kLayers
  std::uint32_t first = 0, count = 0;  // patches
  std::size_t bytes = 0;               // of the header itself
};
[[nodiscard]] std::vector<std::byte> encode_cluster_header(const ClusterHeader& header);
/// Returns nullopt if a field is out of range. Safe for untrusted bytes.
[[nodiscard]] std::optional<ClusterHeader> decode_cluster_header(std::span<const std::byte> payload);

/// Coded displacements of the vertices of one level; empty if none were received.
struct LevelNumbers {
  NumberArray normal, sideways;  // as in ClusterCoder
};

/// Received part of one stage. Any subset of its clusters gives a surface without cracks: vertices without a number
/// stay at their prediction. Not thread-safe.
class Surface {
 public:
  explicit Surface(StageHeader header);

  [[nodiscard]] const StageHeader& header() const { return header_; }
  /// Rejects clusters of deeper levels from now on.
  void limit_depth(int depth) { header_.depth = depth; }
  [[nodiscard]] const Patches& patches() const { return patches_; }
  [[nodiscard]] float step(int layer) const;
  /// Adds the numbers of a cluster. Returns false if it is invalid or truncated, or repeats numbers. Safe for untrusted
  /// bytes: memory and time are proportional to the bytes.
  bool add(const ClusterHeader& cluster, std::span<const std::byte> payload);
  /// Returns the number of clusters received; cluster_bytes() returns their size.
  [[nodiscard]] std::size_t clusters() const { return clusters_; }
  [[nodiscard]] std::size_t cluster_bytes() const { return cluster_bytes_; }
  /// Returns the deepest level with received numbers; 0 if there are none.
  [[nodiscard]] int finest() const { return finest_; }

  /// Returns all numbers of a kind, for encoders.
  [[nodiscard]] LevelNumbers& numbers(int layer, int level);
  /// Returns the received numbers, or nullptr.
  [[nodiscard]] const LevelNumbers* find(int layer, int level) const;
  [[nodiscard]] std::array<NumberArray, 3>& colors(int level);

  /// Returns the patches cut along creases; their vertices have one normal each.
  [[nodiscard]] const Patches& slots() const { return slots_; }
  /// Returns the displacement directions of base vertices at the given positions: means of the sectors' normals.
  [[nodiscard]] std::vector<glm::vec3> base_normals(const std::vector<glm::vec3>& places) const;
  /// Returns the base's vertices on the lattice. Coordinates here and below are relative to Frame.
  [[nodiscard]] std::vector<glm::vec3> base_positions() const;
  /// Returns the vertices of a level with all received displacements.
  [[nodiscard]] std::vector<glm::vec3> positions(int level) const;
  /// Returns the vertices' colours; empty if none were received.
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
  // Patches with received numbers, by layer (colours: kLayers) and level.
  std::array<std::array<std::vector<bool>, kDeepestPatch + 1>, kLayers + 1> taken_;
};

}  // namespace gs::qnv::displaced
