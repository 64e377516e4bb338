#pragma once

#include "qnv/base/cloud.h"
#include "qnv/displaced/surface.h"
#include "qnv/surface/patch_tables.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

/// A direction in 32 bits: x and y 11 each, z 10, from the lowest, two's complement.
[[nodiscard]] std::uint32_t pack_direction(const glm::vec3& unit);
/// About of unit length.
[[nodiscard]] inline glm::vec3 unpack_direction(std::uint32_t packed) {
  const auto part = [&](int left, int right) {
    return static_cast<float>(static_cast<std::int32_t>(packed << left) >> right);
  };
  return {part(21, 21) * (1 / 1023.0f), part(10, 21) * (1 / 1023.0f), part(0, 22) * (1 / 511.0f)};
}

struct PatchVertex {
  glm::vec3 position{0};     // units of the stream
  std::uint32_t normal = 0;  // pack_direction
  friend bool operator==(const PatchVertex&, const PatchVertex&) = default;
};

/// One stage of a displaced surface, as finely as it has come: for every patch its vertices, the coarse ones first. Who
/// lies on an edge is kept by the patches on both sides, with the same place to the last bit. Does not change; what the
/// next state of a stream has in common with this one they share. Any thread.
class PatchSurface {
 public:
  /// What is known of a patch as a whole.
  struct Bounds {
    Box box;  // of its vertices
    glm::vec3 center{0}, axis{0, 0, 1};
    float radius = 0;
    float cosine = -1;  // of the angle that none of its triangles' normals is further from the axis than
  };
  struct Edge {
    std::uint32_t owner = 0, other = displaced::kNone;  // patches beside it; kNone: it is a rim
    glm::vec3 center{0};
    float length = 0, radius = 0;  // along the surface; of a ball about the center that holds it
  };

  /// A surface that was worked out at a level.
  struct Worked {
    std::span<const glm::vec3> places, shifts;   // of vertices, as displaced::Frame has it; their sum counts
    std::span<const std::uint32_t> normals;      // of slots: pack_direction
    std::span<const Rgb8> colors;                // of vertices; empty: they have none
    const std::vector<char>* changed = nullptr;  // patches that are not as they were in `former`; null: all
    const PatchSurface* former = nullptr;        // null: there is none
  };
  /// What is the same in the former state is taken from there.
  [[nodiscard]] static std::shared_ptr<const PatchSurface> make(const displaced::Surface& surface, int level,
                                                                const Box& box, const Worked& worked);
  /// The same of all that has come, worked out here.
  [[nodiscard]] static std::shared_ptr<const PatchSurface> make(const displaced::Surface& surface, int level,
                                                                const Box& box);

  /// The deepest one that patches have.
  [[nodiscard]] int level() const { return level_; }
  [[nodiscard]] std::size_t size() const { return bounds_.size(); }
  [[nodiscard]] bool colored() const { return colored_; }
  /// The new vertices of a level of a patch, in the order of patch_table.
  [[nodiscard]] const PatchVertex* vertices(std::size_t patch, int level) const {
    return blocks_[static_cast<std::size_t>(level)][patch / kBlock]->vertices.data() +
           patch % kBlock * new_patch_vertices(level);
  }
  /// Their colours; only where it is `colored`.
  [[nodiscard]] const Rgb8* colors(std::size_t patch, int level) const {
    return blocks_[static_cast<std::size_t>(level)][patch / kBlock]->colors.data() +
           patch % kBlock * new_patch_vertices(level);
  }
  [[nodiscard]] const Bounds& bounds(std::size_t patch) const { return bounds_[patch]; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }
  /// The edge from corner k to corner k + 1.
  [[nodiscard]] std::uint32_t edge(std::size_t patch, std::size_t k) const { return patch_edges_[patch][k]; }
  /// How many vertices there are, those on edges counted once.
  [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
  /// That it takes.
  [[nodiscard]] std::size_t bytes() const;
  /// Of its vertices' memory, what `other` has, too.
  [[nodiscard]] std::size_t shared_bytes(const PatchSurface& other) const;

  static constexpr std::size_t kBlock = 8;  // patches whose vertices lie together

 private:
  struct Block {
    std::vector<PatchVertex> vertices;
    std::vector<Rgb8> colors;
    friend bool operator==(const Block&, const Block&) = default;
  };

  int level_ = 0;
  bool colored_ = false;
  std::size_t vertex_count_ = 0;
  std::vector<std::vector<std::shared_ptr<const Block>>> blocks_;  // by level
  std::vector<Bounds> bounds_;
  std::vector<Edge> edges_;
  std::vector<std::array<std::uint32_t, 3>> patch_edges_;

  void measure(std::size_t patch);
};

/// All stages of a stream that are shown together.
struct SurfacePatches {
  std::vector<std::shared_ptr<const PatchSurface>> parts;
  [[nodiscard]] std::size_t vertex_count() const;
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] Box box() const;
};

}  // namespace gs::qnv
