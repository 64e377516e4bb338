#pragma once

#include "vrml/events/behaviour.h"
#include "vrml/events/placement.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// A step of the way from the root of the world down to a Shape: a grouping node, an Inline, at last the Shape. A PROTO
/// instance may stand above the node that stands for it.
struct PathStep {
  const SceneGraph* scene = nullptr;
  NodeId node;
  glm::dmat4 world_from_parent{1.0};  // of the coordinate system that the node stands in
};

/// The bearing of the pointing device (VRML97 4.6.7.5) and what it meets first, in world space.
struct Bearing {
  glm::dvec3 origin{0}, direction{0, 0, -1};  // of any length
  glm::dvec3 point{0}, normal{0};             // of the geometry; the normal of any length
  glm::dvec2 texture_coordinate{0};
};

/// Where the pointing device points, and whether its button is down.
struct Pointer {
  Bearing bearing;
  bool down = false;
  std::span<const PathStep> path;  // to the Shape that the bearing meets first; empty: it meets nothing
};

/// What the pointer is over, for those who draw a pointer.
struct PointedAt {
  bool sensor = false;      // it is over an enabled pointing-device sensor's geometry
  bool active = false;      // a sensor has the pointer until the button is released
  NodePlace anchor;         // the first Anchor that it is over; a null scene: none
  std::string description;  // of that
};

/// What a pointing-device sensor does (4.6.7.3): a part of its Behaviour. Numbers are places in Behaviour::events, -1
/// where it has no such event. Pointing sends isOver and isActive; functions that are null have nothing to do.
struct PointingSensor {
  int enabled = -1, is_over = -1, is_active = -1, description = -1;
  bool of_children = false;  // it senses its own children (Anchor), and not its siblings
  /// The pointer moved over its geometry.
  void (*hover)(Execution& execution, EventNode node, const Bearing& bearing,
                const glm::dmat4& world_from_sensor) = nullptr;
  /// It has the pointer from now on.
  void (*press)(Execution& execution, EventNode node, const Bearing& bearing,
                const glm::dmat4& world_from_sensor) = nullptr;
  /// The pointer moved meanwhile.
  void (*drag)(Execution& execution, EventNode node, const Bearing& bearing) = nullptr;
  /// The button was released; `over`: over its geometry.
  void (*release)(Execution& execution, EventNode node, bool over) = nullptr;
};

/// The pointing-device sensors of a world (4.6.7.3 to 4.6.7.5): which of them the pointer is over, and which have it
/// while the button is down. A part of Execution.
///
/// The sensors of the lowest level that has enabled ones take part together. Those that it is over when the button
/// goes down have the pointer until it is released, and no other one hears of it. A change that has no room in the
/// present timestamp, since an isOver or isActive was sent with it, is made in the next step.
class Pointing {
 public:
  explicit Pointing(Execution& execution) : execution_(execution) {}

  void point(const Pointer& pointer);
  /// Does what waited for a new timestamp.
  void go_on();
  /// What stands for PROTO instances may have changed.
  void forget() { siblings_.clear(); }
  /// Whether something waits for a new timestamp.
  [[nodiscard]] bool waits() const { return !waiting_.empty(); }
  [[nodiscard]] PointedAt pointed_at() const;
  /// The enabled sensors that take part where the bearing meets the Shape at the end of the path.
  [[nodiscard]] std::vector<NodePlace> sensors_of(std::span<const PathStep> path);

  /// Of the behaviours of sensors: `enabled` was received.
  void enable(EventNode node, bool enabled);
  /// The sensor is removed from the world.
  void remove(EventNode node);
  /// Sends what a sensor owes that was disabled.
  void settle(EventNode node);

 private:
  struct Sensed {
    EventNode node;
    glm::dmat4 world_from_sensor;
  };
  struct Look {
    Bearing bearing;
    bool down;
    std::vector<Sensed> sensed;  // of the lowest level
  };
  struct Siblings {
    MFNode children;  // shares its storage with the field while that is unchanged
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
  std::unordered_map<const NodeId*, Siblings> siblings_;  // of long lists of children, by where they are kept
  std::vector<Sensed> over_, grabbed_;                    // with some that are that no longer: see PointingState
  std::size_t active_ = 0;                                // of grabbed_
  std::deque<Look> waiting_;
  Bearing last_;
  bool pointed_ = false, down_ = false;
  std::uint32_t look_ = 0, press_ = 0;
};

}  // namespace gs::vrml
