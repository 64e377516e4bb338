#include "app/session/session.h"

#include "render/scene/collector.h"

#include <algorithm>
#include <cmath>
#include <utility>

// Input of the user in the viewports of a session.
namespace gs::app {
namespace {

constexpr float kLeastSpeed = 1e-4f, kMostSpeed = 1e6f;

}  // namespace

void Session::handle(const SessionInput::Event& input) {
  using Kind = WindowEvent::Kind;
  const WindowEvent& event = input.event;
  if (event.kind == Kind::key_down || event.kind == Kind::button_down) pressed_at_ = now_;
  switch (event.kind) {
    case Kind::key_down: {
      // Simulated time runs only the actions of a world: no other files, no reload.
      if (const ActionRow* row = action_of(event); row && (row->of_world || !options_.simulated) && run(row->action))
        return;
      Pane& pane = panes_.at(panes_.active());
      if (const View* seen = pane.view()) (void)pane.input.take(event, seen->navigation.mode);
      return;
    }
    case Kind::axes: {
      // The axes act like held keys. Their motion is cleared in all viewports, because the active one may have changed.
      Pane& pane = panes_.at(panes_.active());
      WindowEvent rest = event;
      rest.move = glm::vec3(0);
      rest.turn = glm::vec2(0);
      for (std::size_t i = 0; i < kMostViewports; ++i) (void)panes_.at(i).input.take(rest, NavigationMode::none);
      if (const View* seen = pane.view()) (void)pane.input.take(event, seen->navigation.mode);
      return;
    }
    case Kind::key_up:
    case Kind::focus_lost:  // releases all keys and drags in all viewports
      for (std::size_t i = 0; i < kMostViewports; ++i) (void)panes_.at(i).input.take(event, NavigationMode::none);
      if (event.kind == Kind::focus_lost) {
        router_.release();
        leave_world();
      }
      return;
    case Kind::button_down:
    case Kind::button_up:
    case Kind::pointer:
    case Kind::wheel:
    case Kind::drop:
      return handle_pointer(input);
    case Kind::pointer_left:
    case Kind::character:
    case Kind::refresh:
      return;
  }
}

void Session::handle_pointer(const SessionInput::Event& input) {
  using Kind = WindowEvent::Kind;
  const WindowEvent& event = input.event;
  if ((event.kind == Kind::button_down || event.kind == Kind::wheel) && input.over_interface) return;
  if (event.kind == Kind::pointer && input.over_interface && !sensor_has_pointer_) leave_world();
  const std::optional<std::size_t> place = router_.route(event, places());
  const std::vector<std::size_t> sight = panes_.visible();
  if (place && *place < sight.size()) {
    const std::size_t target = sight[*place];
    if (event.kind == Kind::button_down || event.kind == Kind::drop) activate(target);
    Pane& pane = panes_.at(target);
    if ((!input.over_interface || sensor_has_pointer_) && !seeking_)
      if (point_with(event, target)) return;
    if (const View* seen = pane.view()) point_at(target, pane.input.take(event, seen->navigation.mode));
  }
  if (event.kind == Kind::drop) open_files(event.paths);
}

bool Session::run(Action action) {
  View* seen = view();
  switch (action) {
    case Action::next_file:
    case Action::previous_file: {
      const std::size_t count = panes_.documents().entries().size();
      if (count == 0) return false;
      const std::size_t step = action == Action::next_file ? 1 : count - 1;
      select_file((panes_.selected().value_or(0) + step) % count);
      return true;
    }
    case Action::reload:
      panes_.reload();
      return true;
    case Action::mute:
    case Action::louder:
    case Action::softer:
      change_sound(action);
      return true;
    case Action::close:
      if (std::exchange(seeking_, false)) {
        tell({}, false, "seek");
        return true;
      }
      return panes_.cancel(panes_.active());
    case Action::back:
    case Action::forward:
      travel(action == Action::back ? -1 : 1);
      return true;
    default:
      return run_in_panes(action) || (seen && run_in(*seen, action));
  }
}

bool Session::run_in(View& seen, Action action) {
  if (const auto mode = place_in(Action::examine, Action::look_at, action)) {
    choose_mode(static_cast<NavigationMode>(1 + *mode));
    return true;
  }
  if (const auto side = place_in(Action::side_front, Action::side_bottom, action)) {
    look_from(static_cast<ViewSide>(*side));
    return true;
  }
  if (const auto display = place_in(Action::display_surface, Action::display_points, action)) {
    seen.style.display = static_cast<render::DisplayMode>(*display);
    tell_of_display(seen);
    return true;
  }
  if (const auto up = place_in(Action::up_auto, Action::up_minus_z, action)) {
    choose_up(seen, static_cast<UpAxis>(*up));
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
      reset();
      return true;
    case Action::fit:
      fit();
      return true;
    case Action::headlight:
      seen.headlight = !seen.headlight;
      return true;
    case Action::ghost:
      seen.navigation.ghost = !seen.navigation.ghost;
      tell(seen.navigation.ghost ? "Collision and gravity off" : "Collision and gravity on", false, "ghost");
      return true;
    case Action::straighten:
      if (seen.navigation.mode != NavigationMode::none)
        seen.navigation = travel_to(seen.navigation, straightened(seen.navigation.pose, seen.navigation.up));
      return true;
    case Action::seek:
      seeking_ = !seeking_ && seen.navigation.mode != NavigationMode::none;
      tell(seeking_ ? "Seek: click a point to move halfway to it" : "", false, "seek");
      return true;
    case Action::undo_move:
    case Action::redo_move:
      undo_move(seen, action == Action::undo_move ? -1 : 1);
      return true;
    case Action::orthographic:
      choose_parallel(seen, !seen.style.parallel);
      tell(seen.style.parallel ? "Parallel projection" : "Perspective projection", false, "rays");
      return true;
    case Action::next_display:
      seen.style.display = static_cast<render::DisplayMode>((static_cast<int>(seen.style.display) + 1) % 4);
      tell_of_display(seen);
      return true;
    case Action::grid:
      seen.style.grid = !seen.style.grid;
      return true;
    case Action::faster:
      change_speed(std::sqrt(2.0f));
      return true;
    case Action::slower:
      change_speed(std::sqrt(0.5f));
      return true;
    default:
      return false;
  }
}

void Session::point_at(std::size_t pane, const InputTracker::Gesture& gesture) {
  if (!gesture.needs_target && !gesture.turns && !gesture.double_click && !gesture.click) return;
  InputTracker& input = panes_.at(pane).input;
  View& seen = *panes_.at(pane).view();
  const Viewport place = place_of(pane);
  Navigation& navigation = seen.navigation;
  const Ray ray = ray_through(navigation.pose, place.inside(input.pointer()), place.size());
  if (gesture.click && std::exchange(seeking_, false)) {
    const auto hit = distance_under(seen, ray, place.size());
    if (hit) navigation = seek(navigation, ray.at(*hit));
    tell(hit ? "" : "No object at this point", false, "seek");
    end_journey(seen);
    leader_ = pane;
    return;
  }
  if (gesture.click) {
    if (navigation.mode != NavigationMode::look_at) return;
    approach(seen, ray, place.size());
    leader_ = pane;
    return;
  }
  const std::optional<float> hit = distance_under(seen, ray, place.size());
  if (gesture.needs_target) input.set_target(target_of(navigation, ray, hit));
  if (gesture.turns && hit) navigation.center = ray.at(*hit);
  const bool turns = navigation.mode == NavigationMode::examine || navigation.mode == NavigationMode::pan;
  if (!gesture.double_click || !turns || !hit) return;
  navigation = look_at_point(navigation, ray.at(*hit));
  leader_ = pane;
}

// Moves to the Shape under the pointer.
void Session::approach(View& seen, const Ray& ray, const glm::vec2& size) {
  const std::optional<Hit> hit = picker_.pick(*seen.list, ray, pick_options(seen, size));
  if (!hit) return;
  render::WorldBounds bounds;
  if (hit->splat) {
    const render::SplatItem& splat = seen.list->splats[*hit->splat];
    const qnv::Box& box = splat.cloud->description.box;
    bounds = render::world_bounds({box.lower, box.upper}, splat.world_from_node);
  } else {
    const render::DrawItem& item = seen.list->items[hit->item];
    bounds = render::world_bounds(item.mesh->bounds, item.world_from_node);
  }
  seen.navigation = app::approach(seen.navigation, hit->point, bounds, size);
  end_journey(seen);
}

std::optional<float> Session::distance_under(const View& seen, const Ray& ray, const glm::vec2& size) {
  const std::optional<Hit> hit = picker_.pick(*seen.list, ray, pick_options(seen, size));
  return hit ? std::optional(hit->distance) : std::nullopt;
}

void Session::choose_mode(NavigationMode mode) {
  View* seen = view();
  if (!seen) return;
  if (!seen->rules.allows(mode)) {
    tell("This world does not allow " + std::string(row_of(mode).label), false);
    return;
  }
  seen->navigation = with_mode(seen->navigation, mode);
  panes_.at(panes_.active()).input.release();
}

void Session::go_to_viewpoint(View& seen, std::size_t index) {
  app::bind_viewpoint(seen, index);
  end_journey(seen);
}

// Moves to the Viewpoint of a link: with an animation only if the NavigationInfo type list has ANY (VRML97 6.29).
void Session::jump_to_viewpoint(View& seen, std::size_t index) {
  go_to_viewpoint(seen, index);
  if (seen.rules.any || !seen.navigation.transition) return;
  seen.navigation.pose = seen.navigation.transition->to;
  seen.navigation.transition.reset();
}

void Session::bind_viewpoint(std::size_t index) {
  View* seen = view();
  if (!seen) return;
  go_to_viewpoint(*seen, index);
  leader_ = panes_.active();
}

void Session::step_viewpoint(int direction) {
  const View* seen = view();
  const std::vector<std::size_t> listed = seen ? listed_viewpoints(seen->list->viewpoints) : std::vector<std::size_t>{};
  if (listed.empty()) return;
  const auto place = std::find(listed.begin(), listed.end(), seen->viewpoint.value_or(listed.front()));
  const std::size_t index = place == listed.end() ? 0 : static_cast<std::size_t>(place - listed.begin());
  const std::size_t count = listed.size();
  const std::size_t next = listed[(index + (direction > 0 ? 1 : count - 1)) % count];
  bind_viewpoint(next);
  tell(viewpoint_label(seen->list->viewpoints[next], next), false, "viewpoint");
}

void Session::fit() {
  if (const View* seen = view()) fly_to(seen->list->bounds);
}

void Session::fly_to(const render::WorldBounds& bounds) {
  View* seen = view();
  if (!seen || bounds.empty() || seen->navigation.mode == NavigationMode::none) return;
  const Viewport place = place_of(panes_.active());
  Navigation& navigation = seen->navigation;
  navigation = travel_to(navigation, pose_that_fits(navigation.pose, bounds, place.size(), navigation.up));
  navigation.center = bounds.center();
  leader_ = panes_.active();
}

void Session::look_from(ViewSide side) {
  View* seen = view();
  if (!seen || seen->list->bounds.empty() || seen->navigation.mode == NavigationMode::none) return;
  Navigation& navigation = seen->navigation;
  const render::WorldBounds& bounds = seen->list->bounds;
  navigation = travel_to(
      navigation, pose_at_side(side, navigation.pose, bounds, place_of(panes_.active()).size(), upright_of(*seen)));
  navigation.center = bounds.center();
  leader_ = panes_.active();
}

void Session::tell_of_display(const View& seen) {
  static constexpr std::string_view kModes[] = {"filled", "filled, with edges", "wireframe", "points"};
  tell(has_faces(*seen.list) ? "Faces: " + std::string(kModes[static_cast<std::size_t>(seen.style.display)])
                             : "Splats and volumes have no faces; their display stays unchanged",
       false);
}

void Session::set_style(const ViewStyle& style) {
  panes_.set_style(style);
  for (std::size_t i = 0; i < kMostViewports; ++i)
    for (auto& [path, seen] : panes_.at(i).views) {
      seen.style.backdrop = style.backdrop;
      seen.style.axes = style.axes;
    }
}

void Session::go_to(const Pose& pose) {
  View* seen = view();
  if (!seen || seen->navigation.mode == NavigationMode::none) return;
  choose_parallel(*seen, pose.height > 0);
  seen->navigation = travel_to(seen->navigation, pose);
  leader_ = panes_.active();
}

void Session::undo_move(View& seen, int direction) {
  if (seen.navigation.mode == NavigationMode::none) return;
  const auto place = seen.history.go(direction, seen.navigation.pose);
  if (place) seen.navigation = travel_to(seen.navigation, *place);
  leader_ = panes_.active();
}

bool Session::can_undo_move(int direction) const {
  const View* seen = panes_.at(panes_.active()).view();
  return seen && seen->history.can_go(direction);
}

void Session::reset() {
  View* seen = view();
  if (!seen) return;
  seen->navigation = travel_to(seen->navigation, seen->home);
  if (!seen->list->bounds.empty()) seen->navigation.center = seen->list->bounds.center();
  leader_ = panes_.active();
}

void Session::change_speed(float factor) {
  Navigation& navigation = view()->navigation;
  if (navigation.speed <= 0) return;
  navigation.speed = std::clamp(navigation.speed * factor, kLeastSpeed, kMostSpeed);
  std::string number = std::to_string(navigation.speed);
  number.resize(std::min<std::size_t>(number.size(), 6));
  tell("Speed " + number + " m/s", false, "speed");
}

void Session::open_files(const std::vector<std::string>& paths) {
  frame_.files_chosen = true;
  // Files that the user opens may be read by worlds that the user opens, as on the command line.
  const std::vector<std::string> places = places_of(paths);
  load_.allowed.insert(load_.allowed.end(), places.begin(), places.end());
  panes_.open(places);
}

// Returns the paths without their Viewpoints, which are stored until the worlds are loaded.
std::vector<std::string> Session::places_of(const std::vector<std::string>& given) {
  std::vector<std::string> places;
  for (const std::string& one : given) {
    const GivenPlace place = given_place(one);
    if (!place.problem.empty()) {
      vrml::Diagnostics said;
      said.add({vrml::Severity::error, one, {}, place.problem});
      log_.note(one, said);
      frame_.failed.push_back({one, place.problem});
      frame_.show_log = true;
      tell("Cannot open " + file_label(one) + ": " + place.problem, true);
      continue;
    }
    if (!place.viewpoint.empty()) entries_[place.target] = place.viewpoint;
    if (place.budget > 0) budgets_[place.target] = place.budget;
    places.push_back(place.target);
  }
  return places;
}

void Session::answer_question(bool allow) {
  if (!questions_.current()) {
    if (const auto asked = network_question())
      panes_.documents().document(asked->world)->runtime->answer_network_question(allow);
    return;
  }
  if (allow) load_.allowed.push_back(questions_.current()->folder);
  for (const std::string& world : questions_.answer(allow)) panes_.reload(world);
}

std::optional<Session::WorldNetworkQuestion> Session::network_question() const {
  for (const DocumentList::Entry& entry : panes_.documents().entries())
    if (entry.document && entry.document->runtime)
      if (auto question = entry.document->runtime->network_question())
        return WorldNetworkQuestion{entry.path, std::move(*question)};
  return std::nullopt;
}

void Session::select_file(std::size_t index) {
  frame_.files_chosen = true;
  panes_.select(index);
}

}  // namespace gs::app
