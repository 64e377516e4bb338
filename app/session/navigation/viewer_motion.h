#pragma once

#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "app/view/picking.h"

#include <cstddef>
#include <span>
#include <vector>

namespace gs::app {

/// Motion of the viewers in the visible viewports, by held keys, drags and animations. Obstacles stop the motion. One
/// thread.
class ViewerMotion {
 public:
  ViewerMotion(StepContext& step, SessionViewports& viewports, Picker& picker)
      : step_(step), viewports_(viewports), picker_(picker) {}

  /// Advances the motion of all viewers by `seconds`. If `look`, updates the render lists for the new positions.
  /// Returns the viewports with a viewer that moved.
  std::vector<std::size_t> advance(float seconds, bool look);
  /// Returns true if a viewer is moving, or if the user holds a key or button.
  [[nodiscard]] bool moving() const;

 private:
  void move(View& view, Navigation after, bool loading, float seconds);
  void link(std::span<const std::size_t> moved);

  StepContext& step_;
  SessionViewports& viewports_;
  Picker& picker_;
};

}  // namespace gs::app
