#pragma once

#include "render/rays/box_tree.h"
#include "render/scene/render_list.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::render {

/// View frustum: the points of world space where all of these linear functions are at least 0.
struct Frustum {
  struct Plane {
    glm::dvec3 normal{0};
    double offset = 0;
  };
  std::array<Plane, 6> planes;

  /// `tangents` are those of the half angles of view; `center` is that of the image centre.
  Frustum(const glm::dmat4& camera_from_world, const glm::vec2& tangents, double near_plane, double far_plane,
          const glm::vec2& center = glm::vec2(0));
  /// Returns true only if the box is outside. May return false for a box outside.
  [[nodiscard]] bool misses(const glm::vec3& lower, const glm::vec3& upper) const;
};

/// Finds the items of large lists that may be in view, by a tree of their boxes. A frame's cost thus depends on the
/// visible items. It builds the tree for the second frame of a list that reports changes (RenderList::generation) and
/// is mostly static; moved items are tested one by one. Caches several lists. Single-threaded.
class VisibleItems {
 public:
  static constexpr std::size_t kMinItems = 1024;  // minimum size of a list for a tree

  /// Returns item indices in the order of the list; null means all items. Valid until the next call.
  [[nodiscard]] const std::vector<std::uint32_t>* find(const RenderList& list, const Frustum& frustum);

 private:
  struct Kept {
    std::uint64_t generation = 0, used = 0;  // used: number of the last call
    std::size_t told = 0;                    // entries of RenderList::moved that were handled
    std::size_t quiet = 0;                   // calls since many items moved
    bool made = false;
    BoxTree tree;
    std::vector<std::uint32_t> loose;  // items that are not, or no longer, in the tree
    std::vector<bool> is_loose;
  };
  static constexpr std::size_t kMaxKept = 4, kQuiet = 30;

  void make(const RenderList& list, Kept& kept);
  Kept& kept_of(const RenderList& list);

  std::vector<Kept> kept_;
  std::uint64_t calls_ = 0;
  std::vector<std::uint64_t> found_bits_;
  std::vector<std::uint32_t> found_;
};

}  // namespace gs::render
