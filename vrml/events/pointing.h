#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/event_model/placement.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::vrml {

/// Step of a path from the root of the world down to a Shape. Its node is a grouping node, an Inline or, at the end,
/// the Shape. A PROTO instance may precede the node that represents the instance.
struct PathStep {
  const SceneGraph* scene = nullptr;
  NodeId node;
  glm::dmat4 world_from_parent{1.0};  // coordinate system of the node's parent
};

/// Bearing of the pointing device (VRML97 4.6.7.5) and its first intersection with geometry, in world space.
struct Bearing {
  glm::dvec3 origin{0}, direction{0, 0, -1};  // `direction` may have any length
  glm::dvec3 point{0}, normal{0};  // intersection; `normal` may have any length
  glm::dvec2 texture_coordinate{0};
};

/// Update of the pointing device: its bearing and the state of its button.
struct Pointer {
  Bearing bearing;
  bool down = false;
  std::span<const PathStep> path;  // path to the first Shape on the bearing; empty if there is none
};

/// Pointer target, from which the program chooses a pointer shape.
struct PointedAt {
  bool sensor = false;  // the pointer is over geometry of an enabled pointing-device sensor
  bool active = false;      // a sensor holds the pointer until the button is released
  NodePlace anchor;  // first Anchor under the pointer; its scene is null if there is none
  std::string description;  // description of that Anchor, or of a sensor of X3D
};

/// Behaviour of a pointing-device sensor (4.6.7.3). The numbers are indices in Behaviour::events, or -1 if the type has
/// no such event. Class Pointing sends isOver and isActive. Null functions are not called.
struct PointingSensor {
  int enabled = -1, is_over = -1, is_active = -1, description = -1;
  bool of_children = false;  // senses its children, like Anchor, instead of its siblings
  /// Called when the pointer has moved over the sensor's geometry.
  void (*hover)(Execution& execution, EventNode node, const Bearing& bearing,
                const glm::dmat4& world_from_sensor) = nullptr;
  /// Called when the sensor grabs the pointer.
  void (*press)(Execution& execution, EventNode node, const Bearing& bearing,
                const glm::dmat4& world_from_sensor) = nullptr;
  /// Called when the pointer has moved while the sensor holds it.
  void (*drag)(Execution& execution, EventNode node, const Bearing& bearing) = nullptr;
  /// Called when the button was released. `over` means that the pointer is over the sensor's geometry.
  void (*release)(Execution& execution, EventNode node, bool over) = nullptr;
};

/// Pointing-device sensors of a world (4.6.7.3 to 4.6.7.5). Tracks the sensors that the pointer is over, and the
/// sensors that hold the pointer while the button is down. Part of Execution.
///
/// The sensors of the lowest level with enabled sensors act together. The sensors under the pointer hold it from the
/// press to the release; until then, no other sensor receives events. If an isOver or isActive event was already sent
/// with the present timestamp, the change waits for the next step.
class Pointing {
 public:
  explicit Pointing(Execution& execution) : execution_(execution) {}

  static constexpr std::size_t kMaxRequests = 64;

  /// Handles a move, press or release of the pointing device. Sends the events of sensors (4.6.7.3) with the present
  /// timestamp.
  void point(const Pointer& pointer);
  /// Applies changes that waited for a new timestamp.
  void go_on();
  /// Sets has_sensors(): the world has a sensor.
  void note_sensor() { has_sensors_ = true; }
  /// Reports whether the world has ever had a pointing-device sensor.
  [[nodiscard]] bool has_sensors() const { return has_sensors_; }
  /// Discards cached lists of siblings, because the content of PROTO instances may have changed.
  void forget() {
    siblings_.clear();
    ++revision_;
  }
  /// Records that the children of a node have changed.
  void note_children_changed() { ++revision_; }
  /// Returns a counter that increases when sensors_of() may change for a path.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// Reports whether a change waits for a new timestamp.
  [[nodiscard]] bool waits() const { return !waiting_.empty(); }
  [[nodiscard]] PointedAt pointed_at() const;
  /// Returns the enabled sensors that react if the bearing hits the Shape at the end of `path`.
  [[nodiscard]] std::vector<NodePlace> sensors_of(std::span<const PathStep> path);
  /// Returns the Anchors that were activated since the last call (6.2), at most kMaxRequests. The caller opens their
  /// URLs.
  [[nodiscard]] std::vector<NodePlace> take_requests() { return std::exchange(requests_, {}); }

  /// Stores the activation of an Anchor for take_requests(). The Anchor's behaviour calls it.
  void request(EventNode anchor);
  /// Handles an `enabled` event of a sensor. The behaviours of sensors call it.
  void enable(EventNode node, bool enabled);
  /// Removes a sensor that leaves the world.
  void remove(EventNode node);
  /// Discards the requests of removed Anchors.
  void forget_removed();
  /// Sends the pending events of a disabled sensor.
  void settle(EventNode node);

 private:
  struct Sensed {
    EventNode node;
    glm::dmat4 world_from_sensor;
  };
  struct Look {
    Bearing bearing;
    bool down;
    std::vector<Sensed> sensed;  // sensors of the lowest level with enabled sensors
  };
  struct Siblings {
    MFNode children;  // copy that shares the field's storage until the field changes
    std::vector<NodeId> sensors;
  };

  void find_sensors(std::span<const PathStep> path, std::vector<Sensed>& sensed);
  void add_sensors(const SceneGraph& scene, const MFNode& children, const glm::dmat4& place,
                   std::vector<Sensed>& sensed);
  void add_sensor(const SceneGraph& scene, NodeId node, const glm::dmat4& place, std::vector<Sensed>& sensed);
  [[nodiscard]] bool make_state(EventNode node);
  [[nodiscard]] bool usable(EventNode node) const;
  [[nodiscard]] bool has_room(const Look& look, bool press, bool release) const;
  bool change(const Look& look);
  void enter(const Look& look, bool moved, bool all);
  void leave();
  void press(const Look& look);
  void release();
  void tell(EventNode node, int event, bool value);

  Execution& execution_;
  std::unordered_map<const NodeId*, Siblings> siblings_;  // caches for long lists of children, by address of the list
  std::vector<Sensed> over_, grabbed_;  // may contain sensors that are no longer over or active: see PointingState
  std::size_t active_ = 0;              // number of active entries of grabbed_
  std::deque<Look> waiting_;
  Bearing last_;
  std::uint64_t revision_ = 0;
  bool enabled_while_down_ = false;  // a sensor was enabled since the press
  bool pointed_ = false, down_ = false;
  std::uint32_t look_ = 0, press_ = 0;
  bool has_sensors_ = false;
  std::vector<NodePlace> requests_;
};

}  // namespace gs::vrml
