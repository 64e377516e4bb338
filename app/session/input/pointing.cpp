#include "app/session/input/pointing.h"

#include "app/session/navigation/camera_control.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

PickOptions options_at(const View& seen, const LayerSight& sight, const glm::vec2& pixel) {
  PickOptions options = pick_options(seen, sight.place.size());
  options.overlay_line = overlay_line(sight.pose, sight.place.inside(pixel), sight.place.size());
  return options;
}

}  // namespace

// Returns the layer of a world that the pointer meets: the front one that it hits; while a sensor has grabbed the
// pointer, the layer of that sensor.
LayerSight Pointing::sight_of(const View& seen, const Viewport& place) {
  const std::vector<LayerSight> sights = layer_sights(*seen.list, seen.navigation.pose, place);
  LayerSight behind{LayerSight::kActive, seen.list.get(), seen.navigation.pose, place};
  const bool held = seen.document->runtime && seen.document->runtime->execution().pointing().pointed_at().active;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const LayerSight& sight = sights[i];
    if (held ? sight.index != held_layer_ : !sight.place.contains(pointer_)) continue;
    behind = sight;
    if (held || i + 1 == sights.size()) break;
    const glm::vec2 size = sight.place.size();
    const Ray ray = ray_through(sight.pose, sight.place.inside(pointer_), size);
    if (picker_.pick(*sight.list, ray, options_at(seen, sight, pointer_))) break;
  }
  held_layer_ = behind.index;
  return behind;
}

// Points at the world of a viewport. Returns true if a sensor has grabbed the pointer; then dragging must not move the
// viewer.
bool Pointing::point_at_world(std::size_t pane, bool down) {
  View* seen = viewports_.panes().at(pane).view();
  if (!seen || !seen->document->runtime) return false;
  vrml::Execution& execution = seen->document->runtime->execution();
  if (!execution.pointing().has_sensors()) return false;
  const Viewport place = viewports_.place_of(pane);
  (void)seen->document->runtime->step(step_.now);
  (void)follow_world(*seen);
  const LayerSight sight = sight_of(*seen, place);
  PickOptions options = options_at(*seen, sight, pointer_);
  options.holds_overlay = held_overlay_;
  const bool held = execution.pointing().pointed_at().active;
  const std::optional<Hit> hit =
      point(execution, picker_, *sight.list, sight_line(sight.pose, sight.place.inside(pointer_), sight.place.size()),
            down, options);
  if (!held) held_overlay_ = hit && !hit->splat && sight.list->items[hit->item].overlay;
  pane_ = pane;
  links_.follow_anchors(pane);
  return execution.pointing().pointed_at().active;
}

void Pointing::leave() {
  if (!pane_) return;
  View* seen = viewports_.panes().at(*std::exchange(pane_, std::nullopt)).view();
  if (seen && seen->document->runtime) seen->document->runtime->execution().pointing().point({});
  sensor_has_pointer_ = false;
}

Pointing::Pointed Pointing::pointed() const {
  const View* seen = viewports_.view();
  if (pane_ != viewports_.panes().active() || !seen || !seen->document->runtime) return {};
  const vrml::PointedAt at = seen->document->runtime->execution().pointing().pointed_at();
  return {at.sensor || at.active, at.description};
}

void Pointing::repeat() {
  if (!pane_) return;
  const std::vector<std::size_t> sight = viewports_.panes().visible();
  if (std::find(sight.begin(), sight.end(), *pane_) == sight.end()) return leave();
  if (!viewports_.panes().at(*pane_).input.holding()) (void)point_at_world(*pane_, sensor_has_pointer_);
}

void Pointing::repeat_in(std::size_t pane) {
  if (pane_ == pane) repeat();
}

void Pointing::note_viewer_moved(std::size_t pane) {
  if (pane_ == pane) moved_ = true;
}

void Pointing::update() {
  if (std::exchange(moved_, false)) repeat();
}

bool Pointing::take(const WindowEvent& event, std::size_t pane) {
  using Kind = WindowEvent::Kind;
  pointer_ = event.pointer;
  if (sensor_has_pointer_ && pane_) {
    if (event.kind == Kind::pointer) {
      moved_ = true;
      return true;
    }
    if (event.kind == Kind::button_up && event.button == MouseButton::left) {
      (void)point_at_world(*pane_, false);
      sensor_has_pointer_ = false;
      return true;
    }
    return event.kind == Kind::button_down;
  }
  if (pane_ && *pane_ != pane) leave();
  pane_ = pane;
  if (event.kind == Kind::pointer) moved_ = true;
  if (event.kind != Kind::button_down || event.button != MouseButton::left || event.shift || event.control)
    return false;
  sensor_has_pointer_ = point_at_world(pane, true);
  if (!sensor_has_pointer_) (void)point_at_world(pane, false);
  return sensor_has_pointer_;
}

std::optional<Pointing::Picked> Pointing::pick_at(const glm::vec2& pixel) {
  const std::vector<std::size_t> sight = viewports_.panes().visible();
  const std::vector<Viewport> rectangles = viewports_.places();
  for (std::size_t i = 0; i < sight.size(); ++i) {
    if (!rectangles[i].contains(pixel)) continue;
    View* seen = viewports_.panes().at(sight[i]).view();
    if (!seen) return std::nullopt;
    for (const LayerSight& layer : layer_sights(*seen->list, seen->navigation.pose, rectangles[i])) {
      if (!layer.place.contains(pixel)) continue;
      const glm::vec2 size = layer.place.size();
      const Ray ray = ray_through(layer.pose, layer.place.inside(pixel), size);
      if (const std::optional<Hit> hit = picker_.pick(*layer.list, ray, options_at(*seen, layer, pixel)))
        return Picked{sight[i], path_of(*layer.list, *hit)};
    }
    return std::nullopt;
  }
  return std::nullopt;
}

// Pressing of sensors without a pointer -----------------------------------------------------------------------

void Pointing::point_at_held_sensor(bool down) {
  View& seen = *viewports_.view();
  vrml::Execution& execution = seen.document->runtime->execution();
  (void)follow_world(seen);
  std::vector<std::size_t> items;
  for (const SensorGeometry& one : sensors_in(seen))
    if (one.sensor.scene == held_sensor_->sensor.scene && one.sensor.node == held_sensor_->sensor.node)
      items = one.items;
  const render::RenderList alone = only(*seen.list, items);
  (void)point(execution, picker_, alone, held_sensor_->line, down);
  links_.follow_anchors(viewports_.panes().active());
}

bool Pointing::press_sensor(const vrml::NodePlace& sensor) {
  View* const seen = viewports_.view();
  if (held_sensor_ || sensor_has_pointer_ || !seen || !seen->document->runtime) return false;
  (void)follow_world(*seen);
  for (const SensorGeometry& one : sensors_in(*seen)) {
    if (one.sensor.scene != sensor.scene || !(one.sensor.node == sensor.node)) continue;
    const auto line = line_that_meets(only(*seen->list, one.items), seen->navigation.pose.position);
    if (!line) return false;
    pane_.reset();  // the pointer no longer points into a world
    held_sensor_ = {sensor, *line};
    point_at_held_sensor(true);
    return true;
  }
  return false;
}

void Pointing::drag_sensor(const glm::dvec2& pixels) {
  const View* const seen = viewports_.view();
  if (!held_sensor_ || !seen || !seen->document->runtime) return;
  glm::dvec3& direction = held_sensor_->line.direction;
  const glm::dvec3 up = seen->navigation.pose.up();
  glm::dvec3 right = glm::cross(direction, up);
  if (!(glm::length(right) > 0)) right = seen->navigation.pose.right();
  right = glm::normalize(right);
  const glm::vec2 size = viewports_.place_of(viewports_.panes().active()).size();
  const double pixel = pick_options(*seen, size).pixel;
  direction = glm::normalize(direction + pixel * (pixels.x * right - pixels.y * glm::cross(right, direction)));
  point_at_held_sensor(true);
}

void Pointing::release_sensor() {
  if (!held_sensor_) return;
  if (const View* const seen = viewports_.view(); seen && seen->document->runtime) point_at_held_sensor(false);
  held_sensor_.reset();
}

}  // namespace gs::app
