#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/displaced/tessellation/patch_tables.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

/// Packs a direction into 32 bits, two's complement: x and y 11 bits each, z 10, from the lowest.
[[nodiscard]] std::uint32_t pack_direction(const glm::vec3& unit);
/// Returns a vector of approximately unit length.
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

/// One stage of a displaced surface, at the detail received so far. Stores the vertices of each patch, coarse ones
/// first. Vertices on an edge are stored for the patches on both sides, with identical bits. Immutable; successive
/// states share unchanged parts. Safe from any thread.
class PatchSurface {
 public:
  /// Bounds of a whole patch.
  struct Bounds {
    Box box;  // of its vertices
    glm::vec3 center{0}, axis{0, 0, 1};
    float radius = 0;
    float cosine = -1;  // cosine of the largest angle between the axis and a triangle's normal
  };
  struct Edge {
    std::uint32_t owner = 0, other = displaced::kNone;  // adjacent patches; `other` is kNone on a rim
    glm::vec3 center{0};
    float length = 0, radius = 0;  // along the surface; of the bounding ball around the centre
  };

  /// Surface after evaluation at a level.
  struct Worked {
    std::span<const glm::vec3> places, shifts;   // of vertices, in Frame units; the position is their sum
    std::span<const std::uint32_t> normals;      // of slots; see pack_direction()
    std::span<const Rgb8> colors;                // of vertices; empty if there are none
    const std::vector<char>* changed = nullptr;  // patches that differ from `former`; nullptr means all
    const PatchSurface* former = nullptr;        // may be nullptr
  };
  /// Makes a surface; shares unchanged parts with the former state.
  [[nodiscard]] static std::shared_ptr<const PatchSurface> make(const displaced::Surface& surface, int level,
                                                                const Box& box, const Worked& worked);
  /// Makes a surface of all received numbers, and evaluates it here.
  [[nodiscard]] static std::shared_ptr<const PatchSurface> make(const displaced::Surface& surface, int level,
                                                                const Box& box);

  /// Returns the deepest level of the patches.
  [[nodiscard]] int level() const { return level_; }
  [[nodiscard]] std::size_t size() const { return bounds_.size(); }
  [[nodiscard]] bool colored() const { return colored_; }
  /// Returns the new vertices of a patch at a level, in the order of patch_table().
  [[nodiscard]] const PatchVertex* vertices(std::size_t patch, int level) const {
    return blocks_[static_cast<std::size_t>(level)][patch / kBlock]->vertices.data() +
           patch % kBlock * new_patch_vertices(level);
  }
  /// Returns their colours. Call only if colored().
  [[nodiscard]] const Rgb8* colors(std::size_t patch, int level) const {
    return blocks_[static_cast<std::size_t>(level)][patch / kBlock]->colors.data() +
           patch % kBlock * new_patch_vertices(level);
  }
  [[nodiscard]] const Bounds& bounds(std::size_t patch) const { return bounds_[patch]; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }
  /// Returns the edge from corner k to corner k + 1.
  [[nodiscard]] std::uint32_t edge(std::size_t patch, std::size_t k) const { return patch_edges_[patch][k]; }
  /// Returns the number of vertices, counting those on edges once.
  [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
  /// Returns the memory in use.
  [[nodiscard]] std::size_t bytes() const;
  /// Returns how much vertex memory is shared with `other`.
  [[nodiscard]] std::size_t shared_bytes(const PatchSurface& other) const;

  static constexpr std::size_t kBlock = 8;  // patches per memory block

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

}  // namespace gs::qnv
