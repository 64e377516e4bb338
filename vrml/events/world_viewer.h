#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/events/idle_sensors.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <span>

namespace gs::vrml {

/// View frustum: tangents of half the horizontal and half the vertical angle.
struct Frustum {
  double right = 0, up = 0;
};

/// Viewer of a world, for sensors and Billboards: set() defines it; before, the bound Viewpoint does. Part of
/// Execution.
class WorldViewer {
 public:
  explicit WorldViewer(Execution& execution) : execution_(execution), idle_(execution) {}

  /// Sets the viewer: world_from_viewer, without scale. Before the first call, the bound Viewpoint is the viewer. If
  /// `sees` is empty, fieldOfView of the bound Viewpoint and the aspect ratio give the frustum.
  void set(const glm::dmat4& world_from_viewer, const std::optional<Frustum>& sees = {});
  [[nodiscard]] bool is_set() const { return world_from_viewer_.has_value(); }
  /// Sets the point about which the viewer turns in EXAMINE, in world space.
  void set_center(const glm::dvec3& center) { center_ = center; }
  [[nodiscard]] const std::optional<glm::dvec3>& center() const { return center_; }
  /// Sets the aspect ratio of the image: width divided by height.
  void set_aspect(double aspect) { aspect_ = aspect; }
  /// Returns world_from_viewer: from set(), or of the bound Viewpoint, or 10 units from the origin along +Z.
  [[nodiscard]] glm::dmat4 pose();
  /// Returns the frustum: from set(), or of the bound Viewpoint. There, fieldOfView is the smaller of both angles
  /// (6.53).
  [[nodiscard]] Frustum frustum() const;
  /// Returns Placement::places_of() of a node; Billboards face the viewer. Valid until the next call of this function
  /// or of pose().
  [[nodiscard]] std::span<const glm::dmat4> places_of(EventNode node);
  /// Reports that the viewer jumps: now, or with the next set() if set() is in use. The viewer does not pass positions
  /// in between. Running nodes are evaluated once more with this timestamp (6.53).
  void jump();
  /// Returns the sensors that rest while the viewer is outside of their boxes.
  [[nodiscard]] IdleSensors& idle() { return idle_; }
  /// Returns the number of jumps so far.
  [[nodiscard]] std::uint32_t jumps() const { return jumps_; }

 private:
  Execution& execution_;
  IdleSensors idle_;
  std::optional<glm::dmat4> world_from_viewer_;
  std::optional<Frustum> frustum_;
  std::optional<glm::dvec3> center_;
  std::uint32_t jumps_ = 0;
  bool jump_ahead_ = false;
  double aspect_ = 4.0 / 3;
};

}  // namespace gs::vrml
