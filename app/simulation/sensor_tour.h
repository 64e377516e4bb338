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

/// Returns the pointing-device sensors and Anchors of a world and its Inlines, or its ProximitySensors if `pointing` is
/// false.
[[nodiscard]] std::vector<vrml::NodePlace> sensors_of(const vrml::SceneGraph& world, bool pointing);

/// Simulated user that tries all sensors of a world. It presses, drags and releases each pointing-device sensor (VRML97
/// 4.6.7.3) and each Anchor, ignoring obstacles. It visits the centre of each ProximitySensor (6.38) and returns.
/// Least-pressed sensors come first, so that late additions get their turn. Deterministic. Used by the session's
/// thread; the session must outlive it.
class SensorTour {
 public:
  struct Counts {
    std::size_t sensors = 0, pressed = 0;  // pointing-device sensors and Anchors
    std::size_t places = 0, visited = 0;   // ProximitySensors
  };

  explicit SensorTour(Session& session) : session_(session) {}

  /// Does the next action in the world of the active viewport. Call after each step of the session.
  void step();
  /// Returns the counts for the world as it is now.
  [[nodiscard]] Counts counts();

 private:
  [[nodiscard]] vrml::Execution* world();
  [[nodiscard]] bool press_next();
  void visit_next();

  Session& session_;
  int phase_ = 0;
  std::uint64_t round_ = 0;  // number of presses
  bool drags_ = false;       // the pressed sensor is dragged
  std::unordered_map<const vrml::Node*, std::uint32_t> presses_;
  std::unordered_map<const vrml::Node*, std::uint32_t> visits_;
  std::optional<glm::dvec3> came_from_;  // viewer position before the visit
};

}  // namespace gs::app
