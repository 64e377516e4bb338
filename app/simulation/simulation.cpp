#include "app/simulation/simulation.h"

#include "app/loading/world_loading.h"
#include "app/script/run_time_nodes.h"
#include "app/streams/stream_feed.h"
#include "app/view/navigation.h"
#include "vrml/syntax/parser.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <utility>

namespace gs::app {
namespace {

SessionOptions simulated(const ViewStyle& style) {
  SessionOptions options;
  options.style = style;
  options.simulated = true;
  return options;
}

}  // namespace

Simulation::Simulation(LoadedWorld world, const glm::ivec2& size, const ViewStyle& style)
    : document_(hold_world(std::move(world))), session_(simulated(style), {}, [] {}) {
  input_.area = Viewport{0, 0, size.x, size.y};
  execution().viewer().set_aspect(static_cast<double>(size.x) / size.y);
}

std::optional<std::string> Simulation::bind_action(const std::string& viewpoint, Action& action) {
  if (viewpoints_.empty())
    viewpoints_ =
        render::collect(*world().scene, world().images, document_->meshes, {0, 0, 10}, world().geometries).viewpoints;
  const auto found = find_viewpoint(viewpoints_, viewpoint);
  if (!found) return "no Viewpoint '" + viewpoint + "'; " + viewpoint_list(viewpoints_);
  action.kind = InputRow::Kind::viewpoint;
  action.scene = viewpoints_[*found].scene;
  action.node = viewpoints_[*found].node;
  return std::nullopt;
}

std::optional<std::string> Simulation::set_action(const InputRow& row, Action& action, SourceLocation& place) {
  place = row.location;
  action.scene = world().scene.get();
  if (!names_) names_ = std::make_unique<vrml::NodeNames>(*world().scene);
  action.node = names_->find(row.name);
  if (!action.node) return "no node '" + row.name + "'; expected a DEF name or Type#number";
  const vrml::NodeType& type = *action.scene->node(action.node).type;
  action.event = type.find_event_in(row.event);
  if (!action.event) return type.name + " has no eventIn '" + row.event + "'";
  place = row.value_location;
  auto value = read_value(row.value, action.event->type, *names_);
  if (!value) return "expected a value of type " + std::string(vrml::name_of(action.event->type));
  action.value = std::move(*value);
  return std::nullopt;
}

std::optional<std::string> Simulation::sensor_action(const InputRow& row, Action& action) {
  if (!names_) names_ = std::make_unique<vrml::NodeNames>(*world().scene);
  action.scene = world().scene.get();
  action.node = action.scene->resolve(names_->find(row.name));
  if (!action.node) return "no node '" + row.name + "'; expected a DEF name or Type#number";
  const vrml::NodeType& type = *action.scene->node(action.node).type;
  if (!type.behaviour || !type.behaviour->pointing) return type.name + " is not a pointing-device sensor";
  action.trouble.message = "no visible object is sensed by '" + row.name + "', or it is disabled; not pressed";
  return std::nullopt;
}

bool Simulation::plan(const std::vector<InputRow>& rows, const std::string& file, Diagnostics& diagnostics) {
  bool good = true;
  for (const InputRow& row : rows) {
    Action action;
    action.time = row.time;
    action.kind = row.kind;
    action.pointer = row.pointer;
    action.place = row.place;
    action.trouble = {Severity::warning, file, row.location, {}};
    SourceLocation place = row.location;
    std::optional<std::string> problem;
    switch (row.kind) {
      case InputRow::Kind::set:
        problem = set_action(row, action, place);
        break;
      case InputRow::Kind::viewpoint:
        problem = bind_action(row.name, action);
        break;
      case InputRow::Kind::press_sensor:
        problem = sensor_action(row, action);
        break;
      case InputRow::Kind::drag_sensor:
      case InputRow::Kind::release_sensor:
      case InputRow::Kind::visit:
        break;
      case InputRow::Kind::move:
      case InputRow::Kind::press:
      case InputRow::Kind::release:
      case InputRow::Kind::key:
        input_action(row, action);
    }
    good = good && !problem;
    if (problem) {
      diagnostics.add({Severity::error, file, place, *problem});
    } else {
      actions_.push_back(std::move(action));
    }
  }
  return good;
}

std::optional<std::string> Simulation::begin_at(const std::string& viewpoint) {
  Action action;
  if (auto problem = bind_action(viewpoint, action)) return problem;
  actions_.insert(actions_.begin(), std::move(action));
  begins_elsewhere_ = true;
  return std::nullopt;
}

void Simulation::input_action(const InputRow& row, Action& action) {
  using Kind = WindowEvent::Kind;
  WindowEvent& event = action.input;
  event.time = row.time;
  if (row.kind == InputRow::Kind::key) {
    event.kind = row.down ? Kind::key_down : Kind::key_up;
    event.key = row.key;
    if (row.key == Key::shift) shift_ = row.down;
    if (row.key == Key::control) control_ = row.down;
  } else {
    event.kind = row.kind == InputRow::Kind::move    ? Kind::pointer
                 : row.kind == InputRow::Kind::press ? Kind::button_down
                                                     : Kind::button_up;
    pointer_ = row.pointer;
  }
  event.pointer = pointer_;
  event.shift = shift_;
  event.control = control_;
}

const View& Simulation::look() {
  step(time_, true);
  return *session_.view();
}

render::Camera Simulation::camera() {
  const View& seen = look();
  // Use the Viewpoint's own matrix, which is more exact than a pose.
  const bool exact = seen.viewpoint && !seen.style.parallel && *seen.viewpoint < seen.list->viewpoints.size() &&
                     !seen.list->viewpoints[*seen.viewpoint].view_all;
  if (at_home(seen) && exact) return viewpoint_camera(*seen.list, seen.bound, seen.home_size);
  return camera_of(seen.navigation.pose);
}

void Simulation::stand_at(const render::Camera& camera) {
  constexpr double kSame = 1e-9;  // tolerance, relative to the distance from the origin
  vrml::Execution& world = execution();
  const glm::dmat4 before = world.viewer().pose(), &after = camera.world_from_camera;
  bool there = true;
  for (int i = 0; i < 4; ++i)
    there = there && glm::distance(before[i], after[i]) <= kSame * std::max(glm::length(after[i]), 1.0);
  if (there || sensors_of(world.scenes().root(), false).empty()) return;
  world.viewer().set(after);
  world.cascade().begin_update();
  (void)document_->runtime->step(world.now());
}

const render::RenderList& Simulation::look_from(const render::Camera& camera) {
  const View& seen = look();
  seen.scene->scene.set_sight(sight_of(seen, camera));
  (void)document_->runtime->show(*seen.scene, glm::dvec3(camera.world_from_camera[3]));
  return *seen.list;
}

void Simulation::step(double time, bool look) {
  time_ = time;
  input_.look = look || session_.motion().moving() || sink_ != nullptr;
  (void)session_.step(kSimulatedStart + time, input_);
  input_.events.clear();
  if (sink_) listen(time);
}

void Simulation::listen(double time) {
  constexpr std::int64_t kPiece = 4096;
  const std::int64_t end = std::llround(time * kMixRate);
  const auto time_of = [](std::int64_t pair) { return kSimulatedStart + static_cast<double>(pair) / kMixRate; };
  std::vector<float> pairs;
  while (heard_ < end) {
    const std::int64_t count = std::min(kPiece, end - heard_);
    pairs.resize(static_cast<std::size_t>(2 * count));
    session_.sound().stage().mixer().mix(time_of(heard_), time_of(heard_ + count), pairs);
    heard_ += count;
    sink_(pairs);
  }
}

void Simulation::choose_viewpoint(const vrml::SceneGraph& scene, vrml::NodeId node) {
  const std::vector<render::ViewpointState>& viewpoints = look().list->viewpoints;
  for (std::size_t i = 0; i < viewpoints.size(); ++i)
    if (viewpoints[i].scene == &scene && viewpoints[i].node == node) return session_.camera().bind_viewpoint(i);
}

void Simulation::act(double time) {
  for (; next_action_ < actions_.size() && actions_[next_action_].time <= time; ++next_action_) {
    const Action& action = actions_[next_action_];
    switch (action.kind) {
      case InputRow::Kind::set:
        (void)execution().send(*action.scene, action.node, *action.event, action.value);
        break;
      case InputRow::Kind::viewpoint:
        choose_viewpoint(*action.scene, action.node);
        break;
      case InputRow::Kind::press_sensor:
        if (!session_.pointing().press_sensor({action.scene, action.node})) troubles_.add(action.trouble);
        break;
      case InputRow::Kind::drag_sensor:
        session_.pointing().drag_sensor(action.pointer);
        break;
      case InputRow::Kind::release_sensor:
        session_.pointing().release_sensor();
        break;
      case InputRow::Kind::visit:
        session_.camera().move_viewer_to(action.place);
        break;
      case InputRow::Kind::move:
      case InputRow::Kind::press:
      case InputRow::Kind::release:
      case InputRow::Kind::key:
        input_.events.push_back({action.input, false});
        step(time, true);
    }
  }
}

// Fetches the urls that were set in the last step. If the fetched content sets further urls, the next step fetches
// them.
void Simulation::fetch() {
  if (!loading_) return;
  std::vector<UrlRequest> requests = document_->runtime->take_url_requests();
  if (requests.empty()) return;
  loading_->request(std::move(requests));
  constexpr std::chrono::milliseconds kWait{1000};
  while (!loading_->done()) (void)loading_->step(kWait);
  ResourceUpdates arrivals = loading_->take_updates();
  for (const auto& feed : arrivals.feeds) (void)feed->apply();
  (void)app::arrive(*document_, std::move(arrivals));
  document_->runtime->execution().loads().end();
}

void Simulation::arrive(ResourceUpdates updates) { (void)app::arrive(*document_, std::move(updates)); }

void Simulation::run(double seconds, const std::function<bool()>& go_on) {
  if (steps_ == 0) {
    if (document_->runtime) document_->runtime->programs().set_settings({0, true});
    if (document_->runtime) document_->runtime->execution().loads().end();
    begin_world(*document_, kSimulatedStart);
    session_.readers().show(document_);
    step(0, false);
    act(0);
    if (begins_elsewhere_) {
      // The event time of sensors does not change here; only objects that follow the viewer are updated again.
      execution().cascade().begin_update();
      step(0, false);
    }
    fetch();
    steps_ = 1;
  }
  // Each step ends at a multiple of kSimulationStep, so that rounding errors do not accumulate.
  double time = time_;
  while (time < seconds && (!go_on || go_on())) {
    const double tick = static_cast<double>(steps_) * kSimulationStep;
    double next = std::min(tick, seconds);
    if (next_action_ < actions_.size()) next = std::min(next, actions_[next_action_].time);
    if (next == tick) ++steps_;
    time = next;
    step(time, false);
    act(time);
    if (tour_) tour_->step();
    fetch();
  }
}

}  // namespace gs::app
