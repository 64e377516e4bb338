#pragma once

#include "vrml/event_model/behaviour.h"

#include <glm/mat4x4.hpp>

#include <cstdint>
#include <optional>
#include <span>

namespace gs::vrml {

/// View frustum: tangents of the half angles to the right and up.
struct Frustum {
  double right = 0, up = 0;
};

/// Viewer of a world, for sensors and Billboards: set from outside, else the bound Viewpoint. Part of Execution.
class WorldViewer {
 public:
  explicit WorldViewer(Execution& execution) : execution_(execution) {}

  /// Sets world_from_viewer, without scale. Before the first call, the bound Viewpoint applies. If `sees` is empty, the
  /// frustum follows from the bound Viewpoint's fieldOfView and the aspect ratio.
  void set(const glm::dmat4& world_from_viewer, const std::optional<Frustum>& sees = {});
  [[nodiscard]] bool is_set() const { return world_from_viewer_.has_value(); }
  /// Sets the aspect ratio of the image: width divided by height.
  void set_aspect(double aspect) { aspect_ = aspect; }
  /// Returns world_from_viewer: from set(), else of the bound Viewpoint, else 10 units from the origin along +Z.
  [[nodiscard]] glm::dmat4 pose();
  /// Returns the frustum: from set(), else by the bound Viewpoint; its fieldOfView is the smaller angle (6.53).
  [[nodiscard]] Frustum frustum() const;
  /// See Placement::places_of. Billboards face the viewer. Valid until the next call of this or of pose().
  [[nodiscard]] std::span<const glm::dmat4> places_of(EventNode node);
  /// Reports a jump. It holds now and, if set() is in use, for its next call. The viewer does not pass positions in
  /// between; running nodes are evaluated once more with this timestamp (6.53).
  void jump();
  /// Returns the number of jumps.
  [[nodiscard]] std::uint32_t jumps() const { return jumps_; }

 private:
  Execution& execution_;
  std::optional<glm::dmat4> world_from_viewer_;
  std::optional<Frustum> frustum_;
  std::uint32_t jumps_ = 0;
  bool jump_ahead_ = false;
  double aspect_ = 4.0 / 3;
};

}  // namespace gs::vrml
