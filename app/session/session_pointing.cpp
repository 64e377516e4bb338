#include "app/session/session.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

// Pointing device in running worlds: their sensors, and Anchors.
namespace gs::app {

PickOptions pick_options(const View& seen, const glm::vec2& size) {
  PickOptions options;
  options.pixel = pixel_along_ray(seen.navigation.pose, size);
  options.clouds = seen.look;
  return options;
}

// Points at the world of a viewport. Returns true if a sensor grabs the pointer, so that it does not move the viewer.
bool Session::point_world(std::size_t pane, bool down) {
  View* seen = panes_.at(pane).view();
  if (!seen || !seen->document->runtime) return false;
  vrml::Execution& execution = seen->document->runtime->execution();
  if (!execution.has_pointing_sensors()) return false;
  const Viewport place = place_of(pane);
  (void)seen->document->runtime->step(now_);
  (void)follow_world(*seen);
  (void)point(execution, picker_, *seen->list, sight_line(seen->navigation.pose, place.inside(pointer_), place.size()),
              down, pick_options(*seen, place.size()));
  pointed_pane_ = pane;
  open_links(pane);
  return execution.pointed_at().active;
}

// Tells the sensors that the pointer has left the world.
void Session::leave_world() {
  if (!pointed_pane_) return;
  View* seen = panes_.at(*std::exchange(pointed_pane_, std::nullopt)).view();
  if (seen && seen->document->runtime) seen->document->runtime->execution().point({});
  sensor_has_pointer_ = false;
}

Session::Pointed Session::pointed() const {
  const View* seen = panes_.at(panes_.active()).view();
  if (pointed_pane_ != panes_.active() || !seen || !seen->document->runtime) return {};
  const vrml::PointedAt at = seen->document->runtime->execution().pointed_at();
  return {at.sensor || at.active, at.description};
}

// Repeats the last pointer position, because the world has moved under the pointer.
void Session::point_again() {
  if (!pointed_pane_) return;
  const std::vector<std::size_t> sight = panes_.visible();
  if (std::find(sight.begin(), sight.end(), *pointed_pane_) == sight.end()) return leave_world();
  if (!panes_.at(*pointed_pane_).input.holding()) (void)point_world(*pointed_pane_, sensor_has_pointer_);
}

// Passes an event to the sensors of the world. Returns true if they handle it.
bool Session::point_with(const WindowEvent& event, std::size_t pane) {
  using Kind = WindowEvent::Kind;
  pointer_ = event.pointer;
  if (sensor_has_pointer_ && pointed_pane_) {
    if (event.kind == Kind::pointer) {
      pointer_moved_ = true;
      return true;
    }
    if (event.kind == Kind::button_up && event.button == MouseButton::left) {
      (void)point_world(*pointed_pane_, false);
      sensor_has_pointer_ = false;
      return true;
    }
    return event.kind == Kind::button_down;
  }
  if (pointed_pane_ && *pointed_pane_ != pane) leave_world();
  pointed_pane_ = pane;
  if (event.kind == Kind::pointer) pointer_moved_ = true;
  if (event.kind != Kind::button_down || event.button != MouseButton::left || event.shift || event.control)
    return false;
  sensor_has_pointer_ = point_world(pane, true);
  if (!sensor_has_pointer_) (void)point_world(pane, false);
  return sensor_has_pointer_;
}

std::optional<Session::Picked> Session::pick_at(const glm::vec2& pixel) {
  const std::vector<std::size_t> sight = panes_.visible();
  const std::vector<Viewport> rectangles = places();
  for (std::size_t i = 0; i < sight.size(); ++i) {
    if (!rectangles[i].contains(pixel)) continue;
    View* seen = panes_.at(sight[i]).view();
    if (!seen) return std::nullopt;
    const glm::vec2 size = rectangles[i].size();
    const Ray ray = ray_through(seen->navigation.pose, rectangles[i].inside(pixel), size);
    const std::optional<Hit> hit = picker_.pick(*seen->list, ray, pick_options(*seen, size));
    if (!hit) return std::nullopt;
    return Picked{sight[i], path_of(*seen->list, *hit)};
  }
  return std::nullopt;
}

// Pressing sensors without a pointer -------------------------------------------------------------------------

bool Session::point_at_sensor(bool down) {
  View& seen = *view();
  vrml::Execution& execution = seen.document->runtime->execution();
  (void)follow_world(seen);
  std::vector<std::size_t> items;
  for (SensorGeometry& one : sensor_geometry(execution, *seen.list))
    if (one.sensor.scene == held_sensor_->sensor.scene && one.sensor.node == held_sensor_->sensor.node)
      items = std::move(one.items);
  const render::RenderList alone = only(*seen.list, items);
  (void)point(execution, picker_, alone, held_sensor_->line, down);
  open_links(panes_.active());
  return execution.pointed_at().active;
}

bool Session::press_sensor(const vrml::NodePlace& sensor) {
  View* const seen = view();
  if (held_sensor_ || sensor_has_pointer_ || !seen || !seen->document->runtime) return false;
  (void)follow_world(*seen);
  for (const SensorGeometry& one : sensor_geometry(seen->document->runtime->execution(), *seen->list)) {
    if (one.sensor.scene != sensor.scene || !(one.sensor.node == sensor.node)) continue;
    const auto line = line_that_meets(only(*seen->list, one.items), seen->navigation.pose.position);
    if (!line) return false;
    pointed_pane_.reset();  // the pointer is no longer in a world
    held_sensor_ = {sensor, *line};
    (void)point_at_sensor(true);
    return true;
  }
  return false;
}

void Session::drag_sensor(const glm::dvec2& pixels) {
  const View* const seen = view();
  if (!held_sensor_ || !seen || !seen->document->runtime) return;
  glm::dvec3& direction = held_sensor_->line.direction;
  const glm::dvec3 up = seen->navigation.pose.up();
  glm::dvec3 right = glm::cross(direction, up);
  if (!(glm::length(right) > 0)) right = seen->navigation.pose.right();
  right = glm::normalize(right);
  const double pixel = pick_options(*seen, place_of(panes_.active()).size()).pixel;
  direction = glm::normalize(direction + pixel * (pixels.x * right - pixels.y * glm::cross(right, direction)));
  (void)point_at_sensor(true);
}

void Session::release_sensor() {
  if (!held_sensor_) return;
  if (const View* const seen = view(); seen && seen->document->runtime) (void)point_at_sensor(false);
  held_sensor_.reset();
}

void Session::move_viewer_to(const glm::dvec3& place) {
  View* const seen = view();
  if (!seen) return;
  seen->navigation.transition.reset();
  seen->navigation.pose.position = place;
}

// Anchors ---------------------------------------------------------------------------------------------

void Session::open_links(std::size_t pane) {
  View* seen = panes_.at(pane).view();
  for (const vrml::NodePlace& anchor : seen->document->runtime->execution().take_requests()) {
    WorldRuntime& runtime = *seen->document->runtime;
    if (vrml::SceneGraph* const scene = runtime.execution().own_scene(*anchor.scene);
        scene && runtime.open_computed_anchor(*scene, anchor.node))
      return;
    const Link link = link_of(*anchor.scene, anchor.node);
    follow_link(pane, link);
    return;  // one link only, because it leaves this world
  }
}

// Moves to the Viewpoint of the link that led here, once the world is running.
void Session::enter_by_link(Pane& pane) {
  View* seen = pane.view();
  const auto entry = entries_.find(pane.shown);
  if (entry == entries_.end() || !seen || !seen->document->runtime) return;
  if (const auto index = find_viewpoint(seen->list->viewpoints, entry->second)) {
    // Acts as if it were the first Viewpoint of the file (VRML97 6.53).
    go_to_viewpoint(*seen, *index);
    if (seen->navigation.transition) seen->navigation.pose = seen->navigation.transition->to;
    seen->navigation.transition.reset();
  } else
    tell("No Viewpoint \"" + entry->second + "\" in this world", true);
  entries_.erase(entry);
}

void Session::follow_link(std::size_t pane, const Link& link) {
  View* seen = panes_.at(pane).view();
  for (std::size_t i = 0; i < link.places.size(); ++i) {
    const Link::Place& place = link.places[i];
    if (!place.problem.empty()) {
      tell(place.problem, true);
      continue;
    }
    const bool here = place.target.empty() || (seen && place.target == seen->document->world.path);
    if (here) {
      if (!seen) continue;
      const auto index = find_viewpoint(seen->list->viewpoints, place.viewpoint);
      if (index) {
        histories_[pane].visit(panes_.at(pane).shown, seen->navigation.pose);
        jump_to_viewpoint(*seen, *index);
      } else
        tell("No Viewpoint \"" + place.viewpoint + "\" in this world", true);
      return;
    }
    if (options_.simulated) return;  // simulated time opens no other worlds and no pages
    if (place.for_browser) {
      frame_.web_pages.push_back(place.target);
      return;
    }
    activate(pane);
    if (link.other_window) {
      if (panes_.visible().size() == 1) choose_layout(ViewportLayout::two);
      const std::vector<std::size_t> sight = panes_.visible();
      const auto mine = std::find(sight.begin(), sight.end(), pane);
      if (sight.size() > 1 && mine != sight.end())
        activate(sight[(static_cast<std::size_t>(mine - sight.begin()) + 1) % sight.size()]);
    }
    if (!place.viewpoint.empty()) entries_[place.target] = place.viewpoint;
    Link behind = link;
    behind.other_window = false;  // this file already has its window
    behind.places.erase(behind.places.begin(), behind.places.begin() + static_cast<std::ptrdiff_t>(i + 1));
    places_behind_[place.target] = std::move(behind);
    // Opens the file without allowing it: only the user grants permission to read files.
    panes_.open(std::vector<std::string>{place.target});
    return;
  }
}

}  // namespace gs::app
