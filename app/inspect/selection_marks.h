#pragma once

#include "app/inspect/node_children.h"
#include "app/inspect/scene_index.h"
#include "app/session/viewports/view.h"
#include "app/view/navigation.h"
#include "app/view/viewports.h"
#include "render/scene/render_list.h"

#include <glm/vec2.hpp>

#include <array>
#include <span>
#include <utility>
#include <vector>

// Positions of nodes in the picture.
namespace gs::app {

/// Returns the world-space bounds of a node with all its USEs. The node is the first of `nodes` that is visible in the
/// list. Empty if none is visible. The time is proportional to the length of the list.
[[nodiscard]] WideBox bounds_in(const render::RenderList& list, std::span<const NodeAt> nodes);

/// Line between two framebuffer pixels.
using PixelLine = std::pair<glm::vec2, glm::vec2>;
/// Projects the edges of a box into a viewport. Clips them at the viewer, so that they are in front of it. Does not
/// clip them at the borders of the viewport.
[[nodiscard]] std::vector<PixelLine> edges_of(const WideBox& box, const Pose& pose, const Viewport& viewport,
                                              const glm::dmat4& world_from_box = glm::dmat4(1));
/// Projects the great circles of a sphere that are perpendicular to the axes. Clips them like edges_of().
[[nodiscard]] std::vector<PixelLine> circles_of(const glm::dvec3& center, double radius, const Pose& pose,
                                                const Viewport& viewport, const glm::dmat4& world_from_sphere);

/// Bounds of the selected node, and its outline in pictures.
class SelectionMark {
 public:
  /// Finds the bounds of a node in a view. In large worlds, the rate of searches is limited. `now` is in seconds of any
  /// clock.
  void find_bounds(const NodeAt& node, const SceneIndex& index, const View& view, double now);
  /// Returns the bounds in world space. Empty if the node is not visible.
  [[nodiscard]] const WideBox& bounds() const { return bounds_; }
  void forget_bounds() { bounds_ = {}; }

  /// Outline in framebuffer pixels, and the viewport that clips it.
  struct Outline {
    Viewport viewport;
    std::vector<PixelLine> lines;
  };
  void add_outline(const Viewport& viewport, const Pose& pose) {
    outlines_.push_back({viewport, edges_of(bounds_, pose, viewport)});
  }
  [[nodiscard]] const std::vector<Outline>& outlines() const { return outlines_; }
  void clear_outlines() { outlines_.clear(); }
  void clear() { *this = {}; }

 private:
  WideBox bounds_;
  NodeAt node_;     // node with the bounds `bounds_`
  double due_ = 0;  // time of the next search
  std::vector<Outline> outlines_;
};

}  // namespace gs::app
