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

/// View frustum in world space. A point is inside if all these linear functions of it are at least 0.
struct Frustum {
  struct Plane {
    glm::dvec3 normal{0};
    double offset = 0;
  };
  std::array<Plane, 6> planes;

  /// Makes the frustum of a camera. `tangents` are those of half the angles of view, `center` those of the image
  /// centre.
  Frustum(const glm::dmat4& camera_from_world, const glm::vec2& tangents, double near_plane, double far_plane,
          const glm::vec2& center = glm::vec2(0));
  /// Returns true only if the box is outside of the frustum. May return false for a box outside.
  [[nodiscard]] bool misses(const glm::vec3& lower, const glm::vec3& upper) const;
};

/// Finds the items of a large list that may be in view, with a tree of their boxes. So the cost of a frame depends on
/// the visible items.
///
/// The list must report changes (RenderList::generation) and be mostly static. The tree is built in the second frame.
/// Moved items are tested one by one. Keeps the trees of several lists. One thread.
class VisibleItems {
 public:
  static constexpr std::size_t kMinItems = 1024;  // minimum items of a list that gets a tree

  /// Returns the indices of items that may be in view, in the order of the list. Null means all items. Valid until the
  /// next call.
  [[nodiscard]] const std::vector<std::uint32_t>* find(const RenderList& list, const Frustum& frustum);

 private:
  struct Kept {
    std::uint64_t generation = 0, used = 0;  // used: serial number of the last call with this list
    std::size_t told = 0;  // number of entries of RenderList::moved that were processed
    std::size_t quiet = 0;  // number of calls after many items moved
    bool made = false;
    BoxTree tree;
    std::vector<std::uint32_t> loose;  // items that are not in the tree
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
