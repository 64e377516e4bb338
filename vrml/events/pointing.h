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

/// Step of the path from the root of the world down to a Shape: a grouping node, an Inline, or finally the Shape. A
/// PROTO instance may precede the node that represents it.
struct PathStep {
  const SceneGraph* scene = nullptr;
  NodeId node;
  glm::dmat4 world_from_parent{1.0};  // parent coordinate system of the node
};

/// Bearing of the pointing device (VRML97 4.6.7.5) and its first intersection, in world space.
struct Bearing {
  glm::dvec3 origin{0}, direction{0, 0, -1};  // direction of any length
  glm::dvec3 point{0}, normal{0};             // intersection; the normal has any length
  glm::dvec2 texture_coordinate{0};
};

/// Bearing of the pointing device and state of its button.
struct Pointer {
  Bearing bearing;
  bool down = false;
  std::span<const PathStep> path;  // to the first Shape on the bearing; empty if there is none
};

/// Pointer target, for choosing a pointer shape.
struct PointedAt {
  bool sensor = false;      // over geometry of an enabled pointing-device sensor
  bool active = false;      // a sensor holds the pointer until the button is released
  NodePlace anchor;         // first Anchor below the pointer; null scene if none
  std::string description;  // description of that Anchor
};

/// Pointing-device part of a Behaviour (4.6.7.3). Numbers are indices in Behaviour::events, -1 if the type has no such
/// event. Pointing sends isOver and isActive. Null functions are not called.
struct PointingSensor {
  int enabled = -1, is_over = -1, is_active = -1, description = -1;
  bool of_children = false;  // senses its own children (Anchor) instead of its siblings
  /// The pointer moved over the sensor's geometry.
  void (*hover)(Execution& execution, EventNode node, const Bearing& bearing,
                const glm::dmat4& world_from_sensor) = nullptr;
  /// The sensor grabs the pointer.
  void (*press)(Execution& execution, EventNode node, const Bearing& bearing,
                const glm::dmat4& world_from_sensor) = nullptr;
  /// The pointer moved while the sensor holds it.
  void (*drag)(Execution& execution, EventNode node, const Bearing& bearing) = nullptr;
  /// The button was released; `over` tells whether the pointer is over the sensor's geometry.
  void (*release)(Execution& execution, EventNode node, bool over) = nullptr;
};

/// Pointing-device sensors of a world (4.6.7.3 to 4.6.7.5): tracks the sensors that the pointer is over, and those that
/// hold it while the button is down. Part of Execution.
///
/// The sensors of the lowest level with enabled ones act together. The sensors under the pointer at the press hold it
/// until the release; no other sensor receives events meanwhile. If an isOver or isActive event was already sent with
/// the present timestamp, the change waits for the next step.
class Pointing {
 public:
  explicit Pointing(Execution& execution) : execution_(execution) {}

  static constexpr std::size_t kMaxRequests = 64;

  /// Handles a move, press or release of the pointing device: sends sensor events (4.6.7.3) with the present timestamp.
  void point(const Pointer& pointer);
  /// Applies changes that waited for a new timestamp.
  void go_on();
  /// Notes that the world has a sensor.
  void note_sensor() { has_sensors_ = true; }
  /// Reports whether the world has ever had a pointing-device sensor.
  [[nodiscard]] bool has_sensors() const { return has_sensors_; }
  /// Invalidates cached lists of siblings, since the content of PROTO instances may have changed.
  void forget() { siblings_.clear(); }
  /// Reports whether a change waits for a new timestamp.
  [[nodiscard]] bool waits() const { return !waiting_.empty(); }
  [[nodiscard]] PointedAt pointed_at() const;
  /// Returns the enabled sensors that act if the bearing hits the Shape at the end of the path.
  [[nodiscard]] std::vector<NodePlace> sensors_of(std::span<const PathStep> path);
  /// Returns and clears the Anchors activated since the last call (6.2), at most kMaxRequests. The caller opens their
  /// URLs.
  [[nodiscard]] std::vector<NodePlace> take_requests() { return std::exchange(requests_, {}); }

  /// Notes the activation of an Anchor; called by its behaviour.
  void request(EventNode anchor);
  /// Handles a sensor's `enabled` event; called by the sensors' behaviours.
  void enable(EventNode node, bool enabled);
  /// Forgets a sensor that is removed from the world.
  void remove(EventNode node);
  /// Forgets requests of removed Anchors.
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
    std::vector<Sensed> sensed;  // sensors of the lowest level
  };
  struct Siblings {
    MFNode children;  // shares storage with the field until the field changes
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
  std::unordered_map<const NodeId*, Siblings> siblings_;  // for long lists of children, by address of the list
  std::vector<Sensed> over_, grabbed_;  // may contain sensors that are no longer over or active; see PointingState
  std::size_t active_ = 0;              // number of active entries of grabbed_
  std::deque<Look> waiting_;
  Bearing last_;
  bool pointed_ = false, down_ = false;
  std::uint32_t look_ = 0, press_ = 0;
  bool has_sensors_ = false;
  std::vector<NodePlace> requests_;
};

}  // namespace gs::vrml
