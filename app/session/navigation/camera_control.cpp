#include "app/session/navigation/camera_control.h"

#include "render/collection/collector.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

constexpr float kMinSpeed = 1e-4f, kMaxSpeed = 1e6f;

}  // namespace

PickOptions pick_options(const View& seen, const glm::vec2& size) {
  PickOptions options;
  options.pixel = pixel_along_ray(seen.navigation.pose, size);
  options.splat_style = seen.look;
  return options;
}

void stand_at(View& seen, const Pose& pose, bool animated) {
  if (seen.navigation.mode == NavigationMode::none) return;
  seen.navigation = travel_to(seen.navigation, pose, !animated);
  if (animated) return;
  seen.navigation.pose = pose;
  seen.navigation.transition.reset();
}

void CameraControl::end_journey(View& seen) const {
  if (!seen.navigation.transition) return;
  const bool instant = seen.navigation.transition->jump && seen.document->runtime &&
                       !seen.document->runtime->execution().browser().settings().viewpoint_animation;
  if (!step_.simulated && !instant) return;
  seen.navigation.pose = seen.navigation.transition->to;
  seen.navigation.transition.reset();
}

bool CameraControl::run(View& seen, Action action) {
  if (const auto mode = place_in(Action::examine, Action::look_at, action)) {
    choose_mode(static_cast<NavigationMode>(1 + *mode));
    return true;
  }
  if (const auto side = place_in(Action::side_front, Action::side_bottom, action)) {
    look_from(seen, static_cast<ViewSide>(*side));
    return true;
  }
  switch (action) {
    case Action::next_viewpoint:
      step_viewpoint(1);
      return true;
    case Action::previous_viewpoint:
      step_viewpoint(-1);
      return true;
    case Action::reset:
      reset(seen);
      return true;
    case Action::fit:
      fly_to(seen.list->bounds);
      return true;
    case Action::ghost:
      seen.navigation.ghost = !seen.navigation.ghost;
      step_.notify(seen.navigation.ghost ? "Collision and gravity off" : "Collision and gravity on", false, "ghost");
      return true;
    case Action::straighten:
      if (seen.navigation.mode != NavigationMode::none)
        seen.navigation = travel_to(seen.navigation, straightened(seen.navigation.pose, seen.navigation.up));
      return true;
    case Action::seek:
      seeking_ = !seeking_ && seen.navigation.mode != NavigationMode::none;
      step_.notify(seeking_ ? "Seek: click a point to move halfway to it" : "", false, "seek");
      return true;
    case Action::undo:
    case Action::redo:
      undo_move(seen, action == Action::undo ? -1 : 1);
      return true;
    case Action::faster:
      change_speed(seen, std::sqrt(2.0f));
      return true;
    case Action::slower:
      change_speed(seen, std::sqrt(0.5f));
      return true;
    default:
      return change_display(seen, action);
  }
}

// Runs an action that changes the style or the axes of a view. Returns false for other actions.
bool CameraControl::change_display(View& seen, Action action) {
  if (const auto display = place_in(Action::display_surface, Action::display_points, action)) {
    seen.style.display = static_cast<render::DisplayMode>(*display);
    describe_display(seen);
    return true;
  }
  if (const auto up = place_in(Action::up_auto, Action::up_minus_z, action)) {
    choose_up(seen, static_cast<UpAxis>(*up));
    return true;
  }
  switch (action) {
    case Action::headlight:
      seen.headlight = !seen.headlight;
      return true;
    case Action::orthographic:
      choose_parallel(seen, !seen.style.parallel);
      step_.notify(seen.style.parallel ? "Parallel projection" : "Perspective projection", false, "rays");
      return true;
    case Action::next_display:
      seen.style.display = static_cast<render::DisplayMode>((static_cast<int>(seen.style.display) + 1) % 4);
      describe_display(seen);
      return true;
    case Action::grid:
      seen.style.grid = !seen.style.grid;
      return true;
    default:
      return false;
  }
}

void CameraControl::describe_display(const View& seen) {
  static constexpr std::string_view kModes[] = {"filled", "filled, with edges", "wireframe", "points"};
  step_.notify(has_faces(*seen.list) ? "Faces: " + std::string(kModes[static_cast<std::size_t>(seen.style.display)])
                                     : "Splats and volumes have no faces; their display stays unchanged",
               false);
}

bool CameraControl::stop_seeking() {
  if (!std::exchange(seeking_, false)) return false;
  step_.notify({}, false, "seek");
  return true;
}

void CameraControl::point_at(std::size_t pane, const InputTracker::Gesture& gesture) {
  if (!gesture.needs_target && !gesture.turns && !gesture.double_click && !gesture.click) return;
  InputTracker& input = viewports_.panes().at(pane).input;
  View& seen = *viewports_.panes().at(pane).view();
  const Viewport place = viewports_.place_of(pane);
  Navigation& navigation = seen.navigation;
  const Ray ray = ray_through(navigation.pose, place.inside(input.pointer()), place.size());
  if (gesture.click && std::exchange(seeking_, false)) {
    const auto hit = distance_under(seen, ray, place.size());
    if (hit) navigation = seek(navigation, ray.at(*hit));
    step_.notify(hit ? "" : "No object at this point", false, "seek");
    end_journey(seen);
    viewports_.lead(pane);
    return;
  }
  if (gesture.click) {
    if (navigation.mode != NavigationMode::look_at) return;
    approach(seen, ray, place.size());
    viewports_.lead(pane);
    return;
  }
  const std::optional<float> hit = distance_under(seen, ray, place.size());
  if (gesture.needs_target) input.set_target(target_of(navigation, ray, hit));
  if (gesture.turns && hit) navigation.center = ray.at(*hit);
  const bool turns = navigation.mode == NavigationMode::examine || navigation.mode == NavigationMode::pan;
  if (!gesture.double_click || !turns || !hit) return;
  navigation = look_at_point(navigation, ray.at(*hit));
  viewports_.lead(pane);
}

// Moves the viewer towards the Shape that the ray hits.
void CameraControl::approach(View& seen, const Ray& ray, const glm::vec2& size) {
  const std::optional<Hit> hit = picker_.pick(*seen.list, ray, pick_options(seen, size));
  if (!hit) return;
  WideBox bounds;
  if (hit->splat) {
    const render::SplatItem& splat = seen.list->splats[*hit->splat];
    const Box& box = splat.geometry->description().box;
    bounds = render::world_bounds({box.lower, box.upper}, splat.world_from_node);
  } else {
    const render::DrawItem& item = seen.list->items[hit->item];
    bounds = render::world_bounds(item.mesh->bounds, item.world_from_node);
  }
  seen.navigation = app::approach(seen.navigation, hit->point, bounds, size);
  end_journey(seen);
}

std::optional<float> CameraControl::distance_under(const View& seen, const Ray& ray, const glm::vec2& size) {
  const std::optional<Hit> hit = picker_.pick(*seen.list, ray, pick_options(seen, size));
  return hit ? std::optional(hit->distance) : std::nullopt;
}

void CameraControl::choose_mode(NavigationMode mode) {
  View* seen = viewports_.view();
  if (!seen) return;
  if (!seen->rules.allows(mode))
    return step_.notify("This world does not allow " + std::string(row_of(mode).label), false);
  seen->navigation = with_mode(seen->navigation, mode);
  viewports_.panes().at(viewports_.panes().active()).input.release();
}

void CameraControl::go_to_viewpoint(View& seen, std::size_t index) {
  app::bind_viewpoint(seen, index);
  end_journey(seen);
}

void CameraControl::jump_to_viewpoint(View& seen, std::size_t index) {
  go_to_viewpoint(seen, index);
  if (seen.rules.any || !seen.navigation.transition) return;
  seen.navigation.pose = seen.navigation.transition->to;
  seen.navigation.transition.reset();
}

void CameraControl::bind_viewpoint(std::size_t index) {
  View* seen = viewports_.view();
  if (!seen) return;
  go_to_viewpoint(*seen, index);
  viewports_.lead_active();
}

void CameraControl::step_viewpoint(int direction) {
  const View* seen = viewports_.view();
  const std::vector<std::size_t> listed =
      seen ? listed_viewpoints(seen->list->viewpoints, seen->navigation.pose.position) : std::vector<std::size_t>{};
  if (listed.empty()) return;
  const auto place = std::find(listed.begin(), listed.end(), seen->viewpoint.value_or(listed.front()));
  const std::size_t index = place == listed.end() ? 0 : static_cast<std::size_t>(place - listed.begin());
  const std::size_t count = listed.size();
  const std::size_t next = listed[(index + (direction > 0 ? 1 : count - 1)) % count];
  bind_viewpoint(next);
  step_.notify(viewpoint_label(seen->list->viewpoints[next], next), false, "viewpoint");
}

void CameraControl::fly_to(const WideBox& bounds) {
  View* seen = viewports_.view();
  if (!seen || bounds.empty() || seen->navigation.mode == NavigationMode::none) return;
  const Viewport place = viewports_.place_of(viewports_.panes().active());
  Navigation& navigation = seen->navigation;
  navigation = travel_to(navigation, pose_that_fits(navigation.pose, bounds, place.size(), navigation.up));
  navigation.center = bounds.center();
  viewports_.lead_active();
}

// Moves the active viewport's viewer to a side of the object in view.
void CameraControl::look_from(View& seen, ViewSide side) {
  if (seen.list->bounds.empty() || seen.navigation.mode == NavigationMode::none) return;
  Navigation& navigation = seen.navigation;
  const WideBox& bounds = seen.list->bounds;
  const Viewport place = viewports_.place_of(viewports_.panes().active());
  navigation = travel_to(navigation, pose_at_side(side, navigation.pose, bounds, place.size(), upright_of(seen)));
  navigation.center = bounds.center();
  viewports_.lead_active();
}

void CameraControl::go_to(const Pose& pose) {
  View* seen = viewports_.view();
  if (!seen || seen->navigation.mode == NavigationMode::none) return;
  choose_parallel(*seen, pose.height > 0);
  seen->navigation = travel_to(seen->navigation, pose);
  viewports_.lead_active();
}

void CameraControl::move_viewer_to(const glm::dvec3& place) {
  View* const seen = viewports_.view();
  if (!seen) return;
  seen->navigation.transition.reset();
  seen->navigation.pose.position = place;
}

void CameraControl::undo_move(View& seen, int direction) {
  if (seen.navigation.mode == NavigationMode::none) return;
  const auto place = seen.history.go(direction, seen.navigation.pose);
  if (place) seen.navigation = travel_to(seen.navigation, *place);
  viewports_.lead_active();
}

bool CameraControl::can_undo_move(int direction) const {
  const View* seen = viewports_.view();
  return seen && seen->history.can_go(direction);
}

void CameraControl::reset(View& seen) {
  seen.navigation = travel_to(seen.navigation, seen.home);
  if (!seen.list->bounds.empty()) seen.navigation.center = seen.list->bounds.center();
  viewports_.lead_active();
}

void CameraControl::change_speed(View& seen, float factor) {
  Navigation& navigation = seen.navigation;
  if (navigation.speed <= 0) return;
  navigation.speed = std::clamp(navigation.speed * factor, kMinSpeed, kMaxSpeed);
  std::string number = std::to_string(navigation.speed);
  number.resize(std::min<std::size_t>(number.size(), 6));
  step_.notify("Speed " + number + " m/s", false, "speed");
}

void CameraControl::set_speed(double factor) {
  const double change = factor / std::exchange(speed_, factor);
  for (Pane& pane : viewports_.panes().all())
    for (auto& [path, seen] : pane.views) seen.navigation.speed *= static_cast<float>(change);
}

}  // namespace gs::app
