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

/// What a camera sees: the places of world space where all of these linear functions are at least 0.
struct Frustum {
  struct Plane {
    glm::dvec3 normal{0};
    double offset = 0;
  };
  std::array<Plane, 6> planes;

  /// `tangents`: of half the angles of view; `center`: of what is in the middle.
  Frustum(const glm::dmat4& camera_from_world, const glm::vec2& tangents, double near_plane, double far_plane,
          const glm::vec2& center = glm::vec2(0));
  /// Nothing of the box is inside. May be false where that is so.
  [[nodiscard]] bool misses(const glm::vec3& lower, const glm::vec3& upper) const;
};

/// Finds the items of large lists that a view may show by a tree of their boxes, so that a frame costs what is in view.
/// The tree is made for the second frame of a list whose changes are told (RenderList::generation) and of which little
/// moves; what moves since is looked at item by item. Keeps a few lists. One thread.
class VisibleItems {
 public:
  static constexpr std::size_t kFewestItems = 1024;  // of a list that is worth a tree

  /// Numbers of items in the order of the list; null: all of them. Valid until the next call.
  [[nodiscard]] const std::vector<std::uint32_t>* find(const RenderList& list, const Frustum& frustum);

 private:
  struct Kept {
    std::uint64_t generation = 0, used = 0;  // used: number of the last call
    std::size_t told = 0;                    // of RenderList::moved
    std::size_t quiet = 0;                   // calls since much moved
    bool made = false;
    BoxTree tree;
    std::vector<std::uint32_t> loose;  // items that the tree does not know, or no longer
    std::vector<bool> is_loose;
  };
  static constexpr std::size_t kMostKept = 4, kQuiet = 30;

  void make(const RenderList& list, Kept& kept);
  Kept& kept_of(const RenderList& list);

  std::vector<Kept> kept_;
  std::uint64_t calls_ = 0;
  std::vector<std::uint64_t> found_bits_;
  std::vector<std::uint32_t> found_;
};

}  // namespace gs::render
