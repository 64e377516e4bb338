#include "app/simulation/sensor_tour.h"

#include "app/view/picking.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr std::uint64_t kPressesOfVisit = 4;  // number of presses between visits of ProximitySensors

void add_scenes(const vrml::SceneGraph& scene, std::vector<const vrml::SceneGraph*>& scenes) {
  scenes.push_back(&scene);
  std::vector<std::uint32_t> places;
  for (const auto& [place, content] : scene.inlines().all())
    if (content) places.push_back(place);
  std::sort(places.begin(), places.end());
  for (const std::uint32_t place : places) add_scenes(*scene.inlines().of(scene.nodes().id_at(place)), scenes);
}

}  // namespace

vrml::Execution* SensorTour::world() {
  const View* const seen = session_.view();
  return seen && seen->document->runtime ? &seen->document->runtime->execution() : nullptr;
}

std::vector<vrml::NodePlace> sensors_of(const vrml::SceneGraph& world, bool pointing) {
  std::vector<vrml::NodePlace> result;
  std::vector<const vrml::SceneGraph*> scenes;
  add_scenes(world, scenes);
  for (const vrml::SceneGraph* const scene : scenes)
    for (std::uint32_t i = 1; i <= scene->nodes().count(); ++i) {
      const vrml::Node& node = scene->nodes().at(i);
      if (!scene->contains(scene->nodes().id_at(i)) || node.in_prototype_body || !node.type->behaviour) continue;
      const vrml::Behaviour& behaviour = *node.type->behaviour;
      if (pointing ? behaviour.pointing != nullptr : behaviour.sensed_place != nullptr)
        result.push_back({scene, scene->nodes().id_at(i)});
    }
  return result;
}

bool SensorTour::press_next() {
  const View& seen = *session_.view();
  struct Candidate {
    std::uint32_t presses;
    const vrml::Node* node;
    vrml::NodePlace sensor;
  };
  std::vector<Candidate> candidates;
  for (const SensorGeometry& one : session_.pointing().sensors_in(seen)) {
    const vrml::Node* const node = &one.sensor.scene->node(one.sensor.node);
    candidates.push_back({presses_[node], node, one.sensor});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.presses < b.presses; });
  // Try only a few sensors in each step. press_sensor() fails for a sensor without collidable geometry, such as lines.
  constexpr std::size_t kTries = 4;
  for (std::size_t i = 0; i < std::min(kTries, candidates.size()); ++i) {
    const Candidate& one = candidates[i];
    drags_ = one.node->type->behaviour->pointing->drag != nullptr;
    ++presses_[one.node];
    if (session_.pointing().press_sensor(one.sensor)) return true;
  }
  return false;
}

void SensorTour::visit_next() {
  if (came_from_) return session_.camera().move_viewer_to(*std::exchange(came_from_, std::nullopt));
  std::vector<vrml::NodePlace> found = sensors_of(world()->scenes().root(), false);
  if (found.empty()) return;
  const auto visits = [&](const vrml::NodePlace& one) { return visits_[&one.scene->node(one.node)]; };
  const auto next =
      std::min_element(found.begin(), found.end(),
                       [&](const vrml::NodePlace& a, const vrml::NodePlace& b) { return visits(a) < visits(b); });
  ++visits_[&next->scene->node(next->node)];
  vrml::Execution& execution = *world();
  const vrml::EventNode sensor = execution.scenes().event_node(*next->scene, next->node);
  if (sensor == 0) return;
  const glm::dvec3 place = next->scene->node(next->node).type->behaviour->sensed_place(execution, sensor);
  const auto frames = execution.viewer().places_of(sensor);
  if (frames.empty()) return;
  came_from_ = session_.view()->navigation.pose.position;
  session_.camera().move_viewer_to(glm::dvec3(frames.front() * glm::dvec4(place, 1)));
}

void SensorTour::step() {
  if (!world()) return;
  constexpr glm::dvec2 kWay(60, -25);  // pixels; movement of a drag
  switch (phase_) {
    case 0:
      if (came_from_ || round_ % kPressesOfVisit == 0) visit_next();
      ++round_;
      if (!press_next()) return;
      break;
    case 1:
      session_.pointing().drag_sensor(round_ % 2 == 0 ? kWay : -kWay);
      break;
    case 2:
      // A click is released where it was pressed. A drag is released where it ends.
      if (!drags_) session_.pointing().drag_sensor(round_ % 2 == 0 ? -kWay : kWay);
      break;
    default:
      session_.pointing().release_sensor();
  }
  phase_ = (phase_ + 1) % 4;
}

SensorTour::Counts SensorTour::counts() {
  Counts result;
  if (!world()) return result;
  for (const vrml::NodePlace& one : sensors_of(world()->scenes().root(), true)) {
    ++result.sensors;
    const auto found = presses_.find(&one.scene->node(one.node));
    if (found != presses_.end() && found->second > 0) ++result.pressed;
  }
  for (const vrml::NodePlace& one : sensors_of(world()->scenes().root(), false)) {
    ++result.places;
    const auto found = visits_.find(&one.scene->node(one.node));
    if (found != visits_.end() && found->second > 0) ++result.visited;
  }
  return result;
}

}  // namespace gs::app
