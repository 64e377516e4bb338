#pragma once

#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "app/view/actions.h"
#include "app/view/picking.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>

namespace gs::app {

/// Returns the options for finding the Shape at a pixel of a view. `size` is the size of the viewport in pixels.
[[nodiscard]] PickOptions pick_options(const View& view, const glm::vec2& size);
/// Moves the viewer of a view to a pose: by an animation if `animated`, else at once. Does nothing if the world forbids
/// navigation.
void stand_at(View& view, const Pose& pose, bool animated);

/// Camera commands for the active viewport: navigation modes, Viewpoints, poses, speed and seeking. One thread.
class CameraControl {
 public:
  /// `speed` is a factor on the viewer speed that worlds set.
  CameraControl(StepContext& step, SessionViewports& viewports, Picker& picker, double speed)
      : step_(step), viewports_(viewports), picker_(picker), speed_(speed) {}

  /// Runs a camera action on a view. Returns false for other actions.
  bool run(View& view, Action action);
  void choose_mode(NavigationMode mode);
  /// Binds the Viewpoint at an index of the active viewport's list.
  void bind_viewpoint(std::size_t index);
  /// Binds the Viewpoint at an index of a view's list, and moves the viewer there.
  void go_to_viewpoint(View& view, std::size_t index);
  /// Moves the viewer to a Viewpoint to which a link leads. The move is animated only if the NavigationInfo type list
  /// has ANY (VRML97 6.29).
  void jump_to_viewpoint(View& view, std::size_t index);
  /// Moves the active viewport's viewer, by an animation, to a pose that shows all of `bounds` (world space).
  void fly_to(const WideBox& bounds);
  /// Moves the active viewport's viewer to a pose by an animation, and applies the projection of the pose.
  void go_to(const Pose& pose);
  /// Moves the active viewport's viewer at once to a position in world space.
  void move_viewer_to(const glm::dvec3& place);
  /// Returns true if the active viewport's viewer can go back (-1) or forward (1) in its history of poses.
  [[nodiscard]] bool can_undo_move(int direction) const;
  /// Sets the factor on the viewer speed that worlds set.
  void set_speed(double factor);
  [[nodiscard]] double speed() const { return speed_; }

  /// Returns true if the next click in the active viewport moves the viewer halfway to a point.
  [[nodiscard]] bool seeking() const { return seeking_; }
  /// Ends seeking. Returns false if it was not active.
  bool stop_seeking();
  /// Applies a gesture of the pointing device in a viewport: it may seek, approach a point, or set the centre of
  /// rotation.
  void point_at(std::size_t pane, const InputTracker::Gesture& gesture);
  /// Completes an animated move to a Viewpoint at once. Has an effect only in simulated time, or if a Script has turned
  /// off the animation of such moves.
  void end_journey(View& view) const;

 private:
  bool change_display(View& view, Action action);
  void step_viewpoint(int direction);
  void look_from(View& view, ViewSide side);
  void undo_move(View& view, int direction);
  void reset(View& view);
  void change_speed(View& view, float factor);
  void approach(View& view, const Ray& ray, const glm::vec2& size);
  [[nodiscard]] std::optional<float> distance_under(const View& view, const Ray& ray, const glm::vec2& size);
  void describe_display(const View& view);

  StepContext& step_;
  SessionViewports& viewports_;
  Picker& picker_;
  double speed_;
  bool seeking_ = false;
};

}  // namespace gs::app
