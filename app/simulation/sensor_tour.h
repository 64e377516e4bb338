#pragma once

#include "app/session/session.h"
#include "vrml/events/execution.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// The pointing-device sensors and Anchors of a world and its Inlines, or the ProximitySensors (`pointing` false).
[[nodiscard]] std::vector<vrml::NodePlace> sensors_of(const vrml::SceneGraph& world, bool pointing);

/// Somebody who tries everything in a world: presses each pointing-device sensor (VRML97 4.6.7.3) and each Anchor,
/// drags and releases it, wherever it is and whatever lies before it, and goes to the middle of each ProximitySensor
/// (6.38) and back; those first that he has pressed least often, so that what comes late has its turn. Does the same in
/// the same world each time. One thread, that of the session, which must outlive it.
class SensorTour {
 public:
  struct Counts {
    std::size_t sensors = 0, pressed = 0;  // pointing-device sensors and Anchors
    std::size_t places = 0, visited = 0;   // ProximitySensors
  };

  explicit SensorTour(Session& session) : session_(session) {}

  /// The next thing that he does, in the world of the active viewport. To be called behind each step of the session.
  void step();
  /// Of the world as it is now.
  [[nodiscard]] Counts counts();

 private:
  [[nodiscard]] vrml::Execution* world();
  [[nodiscard]] bool press_next();
  void visit_next();

  Session& session_;
  int phase_ = 0;
  std::uint64_t round_ = 0;  // presses
  bool drags_ = false;       // the one that is pressed
  std::unordered_map<const vrml::Node*, std::uint32_t> presses_;
  std::unordered_map<const vrml::Node*, std::uint32_t> visits_;
  std::optional<glm::dvec3> came_from_;  // before the visit
};

}  // namespace gs::app
