#pragma once

#include "qnv/base/cloud.h"
#include "qnv/displaced/base_mesh.h"
#include "qnv/displaced/number_array.h"
#include "qnv/displaced/patches.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Steps get finer by this factor from layer to layer.
inline constexpr int kLayers = 4, kLayerShift = 2;
inline constexpr int kMostTriangles = 1 << 17;  // of a base
/// Steps of colours, of 255: luma, and both chromas.
inline constexpr int kLumaStep = 6, kChromaStep = 12;

/// A base mesh and what is needed to displace it: a stage of a stream, which takes the place of the one before.
struct StageHeader {
  int depth = 4;           // 0 to kDeepestPatch: the level whose vertices are as dense as those of the source
  int step_exponent = 10;  // 1 to 24: a residual of layer 0 steps by size / 2^step_exponent, of layer k by 4^k less
  bool colored = false;
  bool beside = false;  // shown with the others: takes no place, and gives none up
  int clusters = 0;     // 0 to 255: once so many have come, this stage takes the place of those before
  BaseMesh base;
};
[[nodiscard]] std::vector<std::byte> encode_stage(const StageHeader& header, std::span<const std::byte> base);
/// Nothing where the bytes are none. Safe for untrusted bytes.
[[nodiscard]] std::optional<StageHeader> decode_stage(std::span<const std::byte> bytes);

/// Surfaces are worked out in units of the longest edge of the stream's box, from its lower corner on: what is as small
/// as a molecule, or far from the origin, is as exact as anything else.
struct Frame {
  glm::vec3 lower{0};
  float size = 1;

  explicit Frame(const Box& box);
  [[nodiscard]] glm::vec3 inside(const glm::vec3& p) const { return (p - lower) / size; }
  [[nodiscard]] glm::vec3 outside(const glm::vec3& p) const { return lower + p * size; }
};

/// Which numbers a cluster holds.
struct ClusterHeader {
  enum class Kind : std::uint8_t { base = 0, displacement = 1, color = 2 };
  Kind kind = Kind::displacement;
  int stage = 0;                       // 0 to 15
  int level = 1;                       // of the new vertices; level 1 brings those of the base too
  int layer = 0;                       // below kLayers
  std::uint32_t first = 0, count = 0;  // patches
  std::size_t bytes = 0;               // of the header itself
};
[[nodiscard]] std::vector<std::byte> encode_cluster_header(const ClusterHeader& header);
/// Nothing where a field is out of its range. Safe for untrusted bytes.
[[nodiscard]] std::optional<ClusterHeader> decode_cluster_header(std::span<const std::byte> payload);

/// Whole numbers of the vertices of one level; empty: none have come.
struct LevelNumbers {
  NumberArray normal, sideways;  // as ClusterCoder has them
};

/// One stage as far as it has arrived. Any subset of its clusters is a surface without cracks: who has got no number
/// stays where it is predicted. One thread.
class Surface {
 public:
  explicit Surface(StageHeader header);

  [[nodiscard]] const StageHeader& header() const { return header_; }
  /// Nothing of deeper levels will be taken.
  void limit_depth(int depth) { header_.depth = depth; }
  [[nodiscard]] const Patches& patches() const { return patches_; }
  [[nodiscard]] float step(int layer) const;
  /// The numbers of a cluster. False where it is none, where its bytes end early, or where some of its numbers came
  /// before. Safe for untrusted bytes: memory and time are in proportion to the bytes.
  bool add(const ClusterHeader& cluster, std::span<const std::byte> payload);
  /// How many have come, and how many bytes they have.
  [[nodiscard]] std::size_t clusters() const { return clusters_; }
  [[nodiscard]] std::size_t cluster_bytes() const { return cluster_bytes_; }
  /// Deepest level of which something has come; 0: none.
  [[nodiscard]] int finest() const { return finest_; }

  /// All numbers of a kind, for who makes them.
  [[nodiscard]] LevelNumbers& numbers(int layer, int level);
  /// Those that have come; null: none.
  [[nodiscard]] const LevelNumbers* find(int layer, int level) const;
  [[nodiscard]] std::array<NumberArray, 3>& colors(int level);

  /// The patches, cut along their creases: whose vertices have normals.
  [[nodiscard]] const Patches& slots() const { return slots_; }
  /// The directions in which vertices of the base at these places are moved: means of the sectors' normals.
  [[nodiscard]] std::vector<glm::vec3> base_normals(const std::vector<glm::vec3>& places) const;
  /// Places of the base's vertices on the lattice. This and all that follows: as Frame has it.
  [[nodiscard]] std::vector<glm::vec3> base_positions() const;
  /// The vertices of a level, with all that has arrived.
  [[nodiscard]] std::vector<glm::vec3> positions(int level) const;
  /// Their colours; empty where none have come.
  [[nodiscard]] std::vector<Rgb8> vertex_colors(int level) const;
  /// Which vertex every slot of a level is.
  [[nodiscard]] std::vector<std::uint32_t> vertices_of_slots(int level) const;
  /// The triangles of a level, as three numbers of slots each.
  [[nodiscard]] std::vector<std::uint32_t> triangles(int level) const;

 private:
  LevelNumbers& sparse(int layer, int level);
  std::array<NumberArray, 3>& sparse_colors(int level);
  bool take_run(const ClusterHeader& cluster);

  StageHeader header_;
  Patches patches_, slots_;
  bool lines_ = false;
  int finest_ = 0;
  std::size_t clusters_ = 0, cluster_bytes_ = 0;
  std::array<std::array<LevelNumbers, kDeepestPatch + 1>, kLayers> numbers_;
  std::array<std::array<NumberArray, 3>, kDeepestPatch + 1> colors_;
  // Of which patches the numbers of a layer (colours: kLayers) and a level have come.
  std::array<std::array<std::vector<bool>, kDeepestPatch + 1>, kLayers + 1> taken_;
};

}  // namespace gs::qnv::displaced
