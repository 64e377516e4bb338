#pragma once

#include "app/session/opening/link_follower.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "app/view/picking.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Pointing device in running worlds: their sensors, and Anchors. One thread.
class Pointing {
 public:
  Pointing(StepContext& step, SessionViewports& viewports, Picker& picker, LinkFollower& links)
      : step_(step), viewports_(viewports), picker_(picker), links_(links) {}

  /// Passes an event to the sensors of a viewport's world. Returns true if they handle it.
  bool take(const WindowEvent& event, std::size_t pane);
  /// Tells the sensors that the pointer has left the world.
  void leave();
  /// Repeats the last pointer position, because the world of this viewport or its viewer has moved.
  void repeat_in(std::size_t pane);
  /// Marks the pointer as moved if it is in this viewport, because the viewer has moved.
  void note_viewer_moved(std::size_t pane);
  /// Updates the sensors if the pointer has moved since they were updated.
  void update();
  /// Returns true if a sensor has the pointer until the button is released.
  [[nodiscard]] bool sensor_has_pointer() const { return sensor_has_pointer_; }

  /// Returns the viewport that receives pointing-device events for sensors.
  [[nodiscard]] std::optional<std::size_t> pane() const { return pane_; }
  /// Object under the pointer in the active viewport: whether a sensor is there or holds the pointer, and the
  /// description of an Anchor (VRML97 6.2).
  struct Pointed {
    bool sensor = false;
    std::string description;
  };
  [[nodiscard]] Pointed pointed() const;
  /// Shape of a visible viewport at a framebuffer pixel.
  struct Picked {
    std::size_t pane = 0;
    std::vector<vrml::PathStep> path;  // from the root of its world to the Shape
  };
  /// Returns nullopt if the pixel is outside of all viewports or shows no Shape.
  [[nodiscard]] std::optional<Picked> pick_at(const glm::vec2& pixel);

  /// Presses a pointing-device sensor or an Anchor of the active viewport's world, along a line from the viewer to its
  /// geometry. Ignores obstacles. Returns false if the sensor has no collidable geometry, is disabled, or if another
  /// sensor has grabbed the pointer.
  [[nodiscard]] bool press_sensor(const vrml::NodePlace& sensor);
  /// Moves the pointer by pixels, right and down, while press_sensor() holds it.
  void drag_sensor(const glm::dvec2& pixels);
  /// Releases the sensor that press_sensor() has pressed.
  void release_sensor();

 private:
  bool point_at_world(std::size_t pane, bool down);
  void point_at_held_sensor(bool down);
  void repeat();

  StepContext& step_;
  SessionViewports& viewports_;
  Picker& picker_;
  LinkFollower& links_;
  std::optional<std::size_t> pane_;  // viewport with the pointing device in its world
  glm::vec2 pointer_{0};             // framebuffer pixels
  bool moved_ = false;               // since sensors were updated
  bool sensor_has_pointer_ = false;
  struct HeldSensor {
    vrml::NodePlace sensor;
    render::SightLine line;
  };
  std::optional<HeldSensor> held_sensor_;  // see press_sensor()
};

}  // namespace gs::app
