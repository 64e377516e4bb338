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

/// Packs a direction into 32 bits: from the lowest, 11 bits for x, 11 for y and 10 for z, each in two's complement.
[[nodiscard]] std::uint32_t pack_direction(const glm::vec3& unit);
/// Unpacks a direction; the result has approximately unit length.
[[nodiscard]] inline glm::vec3 unpack_direction(std::uint32_t packed) {
  const auto part = [&](int left, int right) {
    return static_cast<float>(static_cast<std::int32_t>(packed << left) >> right);
  };
  return {part(21, 21) * (1 / 1023.0f), part(10, 21) * (1 / 1023.0f), part(0, 22) * (1 / 511.0f)};
}

struct PatchVertex {
  glm::vec3 position{0};     // units of the stream
  std::uint32_t normal = 0;  // packed by pack_direction()
  friend bool operator==(const PatchVertex&, const PatchVertex&) = default;
};

/// One stage of a displaced surface, with the detail received so far. Stores the vertices of each patch, coarse levels
/// first. Stores vertices on an edge for the patches on both sides, with identical bits. Immutable. Successive states
/// share unchanged parts. Any thread.
class PatchSurface {
 public:
  /// Bounds of a patch with all its levels.
  struct Bounds {
    Box box;  // of the patch's vertices
    glm::vec3 center{0}, axis{0, 0, 1};
    float radius = 0;
    float cosine = -1;  // cosine of the largest angle between the axis and a triangle's normal
  };
  struct Edge {
    std::uint32_t owner = 0, other = displaced::kNone;  // adjacent patches; `other` is kNone on a rim
    glm::vec3 center{0};
    float length = 0, radius = 0;  // length along the surface; radius of the bounding ball around `center`
  };

  /// Evaluated vertices of a surface at a level: the input of make().
  struct Worked {
    std::span<const glm::vec3> places, shifts;  // per vertex, in Frame units; the position is `places` + `shifts`
    std::span<const std::uint32_t> normals;  // per slot; see pack_direction()
    std::span<const Rgb8> colors;  // per vertex; empty if the surface has no colours
    const std::vector<char>* changed = nullptr;  // patches that differ from `former`; nullptr means all
    const PatchSurface* former = nullptr;  // previous state; nullptr if there is none
  };
  /// Makes a surface from evaluated vertices. The result shares unchanged parts with `worked.former`.
  [[nodiscard]] static std::shared_ptr<const PatchSurface> make(const displaced::Surface& surface, int level,
                                                                const Box& box, const Worked& worked);

  /// Returns the finest level of the patches.
  [[nodiscard]] int level() const { return level_; }
  [[nodiscard]] std::size_t size() const { return bounds_.size(); }
  [[nodiscard]] bool colored() const { return colored_; }
  /// Returns the vertices of a patch that are new at a level, in the order of patch_table().
  [[nodiscard]] const PatchVertex* vertices(std::size_t patch, int level) const {
    return blocks_[static_cast<std::size_t>(level)][patch / kBlock]->vertices.data() +
           patch % kBlock * new_patch_vertices(level);
  }
  /// Returns the colours of the same vertices. Call it only if colored().
  [[nodiscard]] const Rgb8* colors(std::size_t patch, int level) const {
    return blocks_[static_cast<std::size_t>(level)][patch / kBlock]->colors.data() +
           patch % kBlock * new_patch_vertices(level);
  }
  [[nodiscard]] const Bounds& bounds(std::size_t patch) const { return bounds_[patch]; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }
  /// Returns the edge from corner k to corner k + 1.
  [[nodiscard]] std::uint32_t edge(std::size_t patch, std::size_t k) const { return patch_edges_[patch][k]; }
  /// Returns the number of vertices; vertices on edges count once.
  [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
  /// Returns the memory in use, in bytes.
  [[nodiscard]] std::size_t bytes() const;
  /// Returns the vertex memory shared with `other`, in bytes.
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
