#pragma once

#include "app/session/opening/link_follower.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "app/view/layer_sights.h"
#include "app/view/picking.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Pointing device in running worlds. It acts on their pointing-device sensors and Anchors. One thread.
class Pointing {
 public:
  Pointing(StepContext& step, SessionViewports& viewports, Picker& picker, LinkFollower& links)
      : step_(step), viewports_(viewports), picker_(picker), links_(links) {}

  /// Passes an event to the sensors of a viewport's world. Returns true if they handle it.
  bool take(const WindowEvent& event, std::size_t pane);
  /// Informs the sensors that the pointer has left the world.
  void leave();
  /// Repeats the last pointer position, if the pointer is in this viewport. Call after the viewport's world has
  /// changed.
  void repeat_in(std::size_t pane);
  /// Records that the viewer of a viewport has moved. If the pointer is in this viewport, the next update() repeats its
  /// position.
  void note_viewer_moved(std::size_t pane);
  /// Repeats the pointer position if note_viewer_moved() requires it.
  void update();
  /// Returns true if a sensor has grabbed the pointer until the button is released.
  [[nodiscard]] bool sensor_has_pointer() const { return sensor_has_pointer_; }

  /// Returns the viewport that has the pointer over its world.
  [[nodiscard]] std::optional<std::size_t> pane() const { return pane_; }
  /// Object under the pointer in the active viewport. `sensor` is true for a sensor or Anchor under the pointer, or for
  /// one that has grabbed it. `description` is that of the Anchor (VRML97 6.2).
  struct Pointed {
    bool sensor = false;
    std::string description;
  };
  [[nodiscard]] Pointed pointed() const;
  /// Shape that a visible viewport shows at a framebuffer pixel.
  struct Picked {
    std::size_t pane = 0;
    std::vector<vrml::PathStep> path;  // from the root of the world to the Shape
  };
  /// Returns the Shape at a framebuffer pixel; nullopt if the pixel is in no viewport or shows no Shape.
  [[nodiscard]] std::optional<Picked> pick_at(const glm::vec2& pixel);

  /// Returns the sensors and Anchors of a running world that the view shows. Valid until the next call.
  [[nodiscard]] const std::vector<SensorGeometry>& sensors_in(const View& view) {
    return sensor_geometries_.of(view.document->runtime->execution(), *view.list);
  }
  /// Presses a pointing-device sensor or an Anchor in the active viewport's world. Points along a line from the viewer
  /// to its geometry, and ignores obstacles. Returns false if the sensor has no collidable geometry or is disabled, or
  /// if another sensor has grabbed the pointer.
  [[nodiscard]] bool press_sensor(const vrml::NodePlace& sensor);
  /// Moves the pointer that press_sensor() pressed by pixels to the right and down.
  void drag_sensor(const glm::dvec2& pixels);
  /// Releases the sensor that press_sensor() pressed.
  void release_sensor();

 private:
  bool point_at_world(std::size_t pane, bool down);
  LayerSight sight_of(const View& seen, const Viewport& place);
  void point_at_held_sensor(bool down);
  void repeat();

  StepContext& step_;
  SessionViewports& viewports_;
  Picker& picker_;
  SensorGeometries sensor_geometries_;
  LinkFollower& links_;
  std::optional<std::size_t> pane_;  // viewport that has the pointer over its world
  glm::vec2 pointer_{0};             // position in framebuffer pixels
  bool moved_ = false;               // the viewer moved since the sensors were updated
  bool sensor_has_pointer_ = false;
  std::size_t held_layer_ = LayerSight::kActive;  // layer of the sensor that has grabbed the pointer
  bool held_overlay_ = false;                     // that sensor belongs to an overlay
  struct HeldSensor {
    vrml::NodePlace sensor;
    render::SightLine line;
  };
  std::optional<HeldSensor> held_sensor_;  // see press_sensor()
};

}  // namespace gs::app
