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

/// Returns the options for picking in a view, in a viewport of `size` pixels.
[[nodiscard]] PickOptions pick_options(const View& view, const glm::vec2& size);
/// Moves a viewer to a pose: with an animation if `animated`, else at once. Does nothing if the world forbids
/// navigation.
void stand_at(View& view, const Pose& pose, bool animated);

/// Commands for the camera of the active viewport: navigation modes, Viewpoints, poses, speed and seeking. One thread.
class CameraControl {
 public:
  /// `speed` is the factor on the worlds' viewer speed.
  CameraControl(StepContext& step, SessionViewports& viewports, Picker& picker, double speed)
      : step_(step), viewports_(viewports), picker_(picker), speed_(speed) {}

  /// Runs an action on a view. Returns false for all other actions.
  bool run(View& view, Action action);
  void choose_mode(NavigationMode mode);
  /// Binds a Viewpoint of the active viewport's list in its world.
  void bind_viewpoint(std::size_t index);
  /// Binds a Viewpoint in the world of a view, and moves there.
  void go_to_viewpoint(View& view, std::size_t index);
  /// Moves to the Viewpoint of a link: with an animation only if the NavigationInfo type list has ANY (VRML97 6.29).
  void jump_to_viewpoint(View& view, std::size_t index);
  /// Flies the active viewport's viewer to a pose that shows all of `bounds`.
  void fly_to(const WideBox& bounds);
  /// Moves the active viewport's viewer to a pose with an animation, and applies the pose's projection.
  void go_to(const Pose& pose);
  /// Moves the active viewport's viewer at once.
  void move_viewer_to(const glm::dvec3& place);
  /// Returns true if the active viewport's viewer can move back (-1) or forward (1) in its history of poses.
  [[nodiscard]] bool can_undo_move(int direction) const;
  /// Sets the factor on the worlds' viewer speed.
  void set_speed(double factor);
  [[nodiscard]] double speed() const { return speed_; }

  /// Returns true if the next click in the active viewport seeks.
  [[nodiscard]] bool seeking() const { return seeking_; }
  /// Ends seeking. Returns false if the next click does not seek.
  bool stop_seeking();
  /// Applies a gesture of the pointing device in a viewport: seeking, approaching, and centres of rotation.
  void point_at(std::size_t pane, const InputTracker::Gesture& gesture);
  /// Completes the move to a Viewpoint at once in simulated time.
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
