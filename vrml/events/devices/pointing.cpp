#include "vrml/events/pointing.h"

#include "vrml/events/execution.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kLongList = 64;  // minimum length of a list of children for which its sensors are cached
constexpr std::size_t kMaxLists = 256;
constexpr std::size_t kMaxWaiting = 64;

const PointingSensor* pointing_sensor_of(const Node& node) {
  return node.type->behaviour ? node.type->behaviour->pointing : nullptr;
}

}  // namespace

// ---- Finding sensors (4.6.7.3)

// Finds the sensors of the lowest level with enabled sensors. The levels of a path are lists of children: of the path's
// grouping nodes, and the roots of each scene. A Switch or LOD contributes only its child on the path, which is not a
// sensor.
void Pointing::find_sensors(std::span<const PathStep> path, std::vector<Sensed>& sensed) {
  for (std::size_t i = path.size(); i-- > 0 && sensed.empty();) {
    const PathStep& step = path[i];
    if (!step.scene || !step.scene->contains(step.node)) continue;
    const Node& node = step.scene->node(step.node);
    if (i + 1 < path.size() && node.type->kind == NodeType::Kind::built_in) {
      const glm::dmat4& place = path[i + 1].world_from_parent;
      const bool chooses = node.type->read_as == NodeKind::switch_node || node.type->read_as == NodeKind::lod;
      const InterfaceDeclaration* field =
          has(node.type->role, Role::grouping) && !chooses ? node.type->find_field("children") : nullptr;
      if (field && field->type == FieldType::MFNode)
        add_sensors(*step.scene, *std::get_if<MFNode>(&node.values[field->slot]), place, sensed);
      const PointingSensor* own = pointing_sensor_of(node);
      if (own && own->of_children) add_sensor(*step.scene, step.node, place, sensed);
    }
    if (sensed.empty() && (i == 0 || path[i - 1].scene != step.scene))
      add_sensors(*step.scene, step.scene->roots(), step.world_from_parent, sensed);
  }
}

void Pointing::add_sensors(const SceneGraph& scene, const MFNode& children, const glm::dmat4& place,
                           std::vector<Sensed>& sensed) {
  const auto find = [&](std::vector<NodeId>& found) {
    std::unordered_set<std::uint32_t> seen;
    for (const NodeId child : children) {
      const NodeId id = scene.resolve(child);
      if (!id) continue;
      const PointingSensor* sensor = pointing_sensor_of(scene.node(id));
      if (sensor && !sensor->of_children && seen.insert(id.index).second) found.push_back(id);
    }
  };
  std::vector<NodeId> found;
  const std::vector<NodeId>* sensors = &found;
  if (children.size() < kLongList) {
    find(found);
  } else {
    if (siblings_.size() >= kMaxLists) siblings_.clear();
    Siblings& known = siblings_[children.data()];
    if (!known.children.shares_with(children)) {
      known = {children, {}};
      find(known.sensors);
    }
    sensors = &known.sensors;
  }
  for (const NodeId id : *sensors) add_sensor(scene, id, place, sensed);
}

void Pointing::add_sensor(const SceneGraph& scene, NodeId id, const glm::dmat4& place, std::vector<Sensed>& sensed) {
  const EventNode node = execution_.scenes().event_node(scene, id);
  if (node != 0 && make_state(node) && usable(node)) sensed.push_back({node, place});
}

std::vector<NodePlace> Pointing::sensors_of(std::span<const PathStep> path) {
  std::vector<Sensed> sensed;
  find_sensors(path, sensed);
  std::vector<NodePlace> result;
  for (const Sensed& one : sensed) result.push_back(execution_.nodes().place_of(one.node));
  return result;
}

bool Pointing::make_state(EventNode node) {
  if (execution_.nodes().state_of(node) != 0) return true;
  auto& states = execution_.states().pointing;
  if (!states.has_spare() && !execution_.budget().afford(sizeof(PointingState))) return false;
  execution_.nodes().state_of(node) = states.take();
  return true;
}

// Reports whether a sensor may react. A sensor that was enabled while the button is down must wait until the release
// (4.6.7.3).
bool Pointing::usable(EventNode node) const {
  const int enabled = execution_.nodes().behaviour_of(node).pointing->enabled;
  if (enabled >= 0 && !execution_.get<SFBool>(node, enabled)) return false;
  return !down_ || execution_.states().pointing[execution_.nodes().state_of(node)].enabled_in != press_;
}

// ---- Sending events

void Pointing::point(const Pointer& pointer) {
  Look look{pointer.bearing, pointer.down, {}};
  find_sensors(pointer.path, look.sensed);
  if (!waiting_.empty() || !change(look)) {
    if (!waiting_.empty() && waiting_.back().down == look.down) {
      waiting_.back() = std::move(look);
    } else if (waiting_.size() < kMaxWaiting) {
      waiting_.push_back(std::move(look));
    } else {
      waiting_.pop_back();  // drops a press and its release, which could not be sent
    }
  }
  execution_.cascade().drain();
}

void Pointing::request(EventNode anchor) {
  if (requests_.size() >= kMaxRequests) requests_.erase(requests_.begin());
  requests_.push_back(execution_.nodes().place_of(anchor));
}

void Pointing::forget_removed() {
  std::erase_if(requests_, [&](const NodePlace& one) {
    return !execution_.scenes().has(one.scene) || !one.scene->contains(one.node);
  });
}

void Pointing::go_on() {
  while (!waiting_.empty() && change(waiting_.front())) waiting_.pop_front();
}

// Reports whether all sensors that would change their state can send events with this timestamp.
bool Pointing::has_room(const Look& look, bool press, bool release) const {
  const auto& states = execution_.states().pointing;
  const auto sent = [&](EventNode node, int event) { return event >= 0 && execution_.has_sent(node, event); };
  for (const Sensed& one : over_) {
    const PointingState& state = states[execution_.nodes().state_of(one.node)];
    if (state.over && state.wanted != look_ &&
        sent(one.node, execution_.nodes().behaviour_of(one.node).pointing->is_over))
      return false;
  }
  for (const Sensed& one : look.sensed) {
    const PointingState& state = states[execution_.nodes().state_of(one.node)];
    const PointingSensor& sensor = *execution_.nodes().behaviour_of(one.node).pointing;
    if (state.wanted != look_) continue;
    const bool enters = !state.over && (active_ == 0 || release || state.active);
    if ((enters && sent(one.node, sensor.is_over)) || (press && sent(one.node, sensor.is_active))) return false;
  }
  for (const Sensed& one : grabbed_)
    if (release && states[execution_.nodes().state_of(one.node)].active &&
        sent(one.node, execution_.nodes().behaviour_of(one.node).pointing->is_active))
      return false;
  return true;
}

// Applies an update of the pointer. Returns false and changes nothing if an event cannot be sent with this timestamp.
bool Pointing::change(const Look& look) {
  const bool pressed = look.down && !down_, released = !look.down && down_;
  const bool moved = !pointed_ || look.bearing.origin != last_.origin || look.bearing.direction != last_.direction;
  // Geometry that moves under a pointer at rest causes no events (6.51).
  if (!pressed && !released && !moved) return true;
  auto& states = execution_.states().pointing;
  ++look_;
  for (const Sensed& one : look.sensed)
    if (usable(one.node)) states[execution_.nodes().state_of(one.node)].wanted = look_;
  if (!has_room(look, pressed, released)) return false;
  pointed_ = true;
  last_ = look.bearing;
  if (!look.down && std::exchange(enabled_while_down_, false)) ++revision_;
  down_ = look.down;
  leave();
  enter(look, moved, active_ == 0);
  if (pressed) press(look);
  for (const Sensed& one : grabbed_)
    if (const auto drag = execution_.nodes().behaviour_of(one.node).pointing->drag;
        drag && !pressed && moved && states[execution_.nodes().state_of(one.node)].active)
      drag(execution_, one.node, look.bearing);
  if (released) {
    release();
    enter(look, false, true);
  }
  return true;
}

void Pointing::tell(EventNode node, int event, bool value) {
  if (event >= 0) execution_.send(node, event, SFBool{value});
}

void Pointing::leave() {
  auto& states = execution_.states().pointing;
  std::erase_if(over_, [&](const Sensed& one) {
    PointingState& state = states[execution_.nodes().state_of(one.node)];
    if (state.over && state.wanted == look_) return false;
    if (std::exchange(state.over, false))
      tell(one.node, execution_.nodes().behaviour_of(one.node).pointing->is_over, false);
    return true;
  });
}

// Updates the sensors under the pointer. If `moved`, the sensors that were under it before receive hover events. Unless
// `all`, updates only sensors that hold the pointer.
void Pointing::enter(const Look& look, bool moved, bool all) {
  auto& states = execution_.states().pointing;
  for (const Sensed& one : look.sensed) {
    PointingState& state = states[execution_.nodes().state_of(one.node)];
    if (state.wanted != look_ || !(all || state.active)) continue;
    const PointingSensor& sensor = *execution_.nodes().behaviour_of(one.node).pointing;
    const bool enters = !std::exchange(state.over, true);
    if (enters) {
      over_.push_back(one);
      tell(one.node, sensor.is_over, true);
    }
    if ((enters || moved) && sensor.hover) sensor.hover(execution_, one.node, look.bearing, one.world_from_sensor);
  }
}

void Pointing::press(const Look& look) {
  auto& states = execution_.states().pointing;
  ++press_;
  grabbed_.clear();
  for (const Sensed& one : look.sensed) {
    PointingState& state = states[execution_.nodes().state_of(one.node)];
    if (state.wanted != look_) continue;
    state.active = true;
    ++active_;
    grabbed_.push_back(one);
    const PointingSensor& sensor = *execution_.nodes().behaviour_of(one.node).pointing;
    tell(one.node, sensor.is_active, true);
    if (sensor.press) sensor.press(execution_, one.node, look.bearing, one.world_from_sensor);
  }
}

void Pointing::release() {
  auto& states = execution_.states().pointing;
  for (const Sensed& one : std::exchange(grabbed_, {})) {
    PointingState& state = states[execution_.nodes().state_of(one.node)];
    if (!std::exchange(state.active, false)) continue;
    const PointingSensor& sensor = *execution_.nodes().behaviour_of(one.node).pointing;
    tell(one.node, sensor.is_active, false);
    if (sensor.release) sensor.release(execution_, one.node, state.over);
  }
  active_ = 0;
}

// ---- enabled

void Pointing::enable(EventNode node, bool enabled) {
  ++revision_;
  enabled_while_down_ = enabled_while_down_ || (enabled && down_);
  if (enabled) {
    if (down_ && make_state(node)) execution_.states().pointing[execution_.nodes().state_of(node)].enabled_in = press_;
    return;
  }
  if (execution_.nodes().state_of(node) == 0) return;
  PointingState& state = execution_.states().pointing[execution_.nodes().state_of(node)];
  state.owes_over = std::exchange(state.over, false) || state.owes_over;
  if (std::exchange(state.active, false)) {
    state.owes_active = true;
    --active_;
  }
  if (state.owes_over || state.owes_active) execution_.timers().look_again(node);
}

void Pointing::settle(EventNode node) {
  if (execution_.nodes().state_of(node) == 0) return;
  PointingState& state = execution_.states().pointing[execution_.nodes().state_of(node)];
  const PointingSensor& sensor = *execution_.nodes().behaviour_of(node).pointing;
  const auto pay = [&](bool& owed, int event) {
    if (!owed || (event >= 0 && execution_.has_sent(node, event))) return;
    owed = false;
    tell(node, event, false);
  };
  pay(state.owes_active, sensor.is_active);
  pay(state.owes_over, sensor.is_over);
  execution_.timers().run(node, state.owes_active || state.owes_over);
}

void Pointing::remove(EventNode node) {
  ++revision_;
  const auto is_it = [&](const Sensed& one) { return one.node == node; };
  std::erase_if(over_, is_it);
  std::erase_if(grabbed_, is_it);
  for (Look& look : waiting_) std::erase_if(look.sensed, is_it);
  auto& states = execution_.states().pointing;
  if (execution_.nodes().state_of(node) != 0 && states[execution_.nodes().state_of(node)].active) --active_;
  states.give_back(execution_.nodes().state_of(node));
}

PointedAt Pointing::pointed_at() const {
  PointedAt result;
  result.active = active_ > 0;
  for (const Sensed& one : over_) {
    if (!execution_.states().pointing[execution_.nodes().state_of(one.node)].over) continue;
    result.sensor = true;
    const PointingSensor& sensor = *execution_.nodes().behaviour_of(one.node).pointing;
    if (!sensor.of_children) {  // sensors of X3D have a description too
      if (result.description.empty() && sensor.description >= 0 &&
          execution_.nodes().has_event(one.node, sensor.description))
        result.description = execution_.get<SFString>(one.node, sensor.description).str();
      continue;
    }
    if (result.anchor.scene) continue;
    result.anchor = execution_.nodes().place_of(one.node);
    if (sensor.description >= 0) result.description = execution_.get<SFString>(one.node, sensor.description).str();
  }
  return result;
}

}  // namespace gs::vrml
