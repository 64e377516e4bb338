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

/// Returns the sensors of a world and its Inlines: the pointing-device sensors and Anchors if `pointing`, else the
/// ProximitySensors.
[[nodiscard]] std::vector<vrml::NodePlace> sensors_of(const vrml::SceneGraph& world, bool pointing);

/// Simulated user that tries all sensors of a world. It presses, drags and releases each pointing-device sensor (VRML97
/// 4.6.7.3) and each Anchor, even behind obstacles. It moves to the centre of each ProximitySensor (6.38) and back.
/// Sensors with the fewest presses come first, so that sensors added later get their turn. Deterministic. Runs on the
/// session's thread; the session must outlive it.
class SensorTour {
 public:
  struct Counts {
    std::size_t sensors = 0, pressed = 0;  // numbers of pointing-device sensors and Anchors
    std::size_t places = 0, visited = 0;  // numbers of ProximitySensors
  };

  explicit SensorTour(Session& session) : session_(session) {}

  /// Does the next action in the world of the active viewport. Call after each step of the session.
  void step();
  /// Returns the counts for the sensors that the world has now.
  [[nodiscard]] Counts counts();

 private:
  [[nodiscard]] vrml::Execution* world();
  [[nodiscard]] bool press_next();
  void visit_next();

  Session& session_;
  int phase_ = 0;
  std::uint64_t round_ = 0;  // number of presses so far
  bool drags_ = false;  // the pressed sensor can be dragged
  std::unordered_map<const vrml::Node*, std::uint32_t> presses_;
  std::unordered_map<const vrml::Node*, std::uint32_t> visits_;
  std::optional<glm::dvec3> came_from_;  // position of the viewer before the visit; nullopt outside of a visit
};

}  // namespace gs::app
