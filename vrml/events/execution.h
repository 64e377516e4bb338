#pragma once

#include "base/noncopyable.h"
#include "vrml/event_model/event_budget.h"
#include "vrml/event_model/placement.h"
#include "vrml/event_model/states.h"
#include "vrml/events/bindable_stacks.h"
#include "vrml/events/change_list.h"
#include "vrml/events/event_cascade.h"
#include "vrml/events/event_nodes.h"
#include "vrml/events/key_device.h"
#include "vrml/events/node_lifetime.h"
#include "vrml/events/placed_shapes.h"
#include "vrml/events/pointing.h"
#include "vrml/events/route_table.h"
#include "vrml/events/script_queue.h"
#include "vrml/events/timer_queue.h"
#include "vrml/events/url_loads.h"
#include "vrml/events/world_browser.h"
#include "vrml/events/world_scenes.h"
#include "vrml/events/world_viewer.h"

#include <optional>
#include <utility>

namespace gs::vrml {

/// Execution model of VRML97 (4.10, 4.11) for a world and its attached Inlines. Owns the classes that share this work,
/// and advances the time.
///
/// The cost of a step is proportional to the number of events in it. Memory is charged to the scene's budget. If the
/// budget is exhausted, further nodes take no part in events, and EventBudget::problem reports it. Cascades with too
/// much work end early. Runs on the scene's thread only; the scene must outlive this object.
class Execution : NonCopyable {
 public:
  explicit Execution(SceneGraph& root);

  /// Starts the world at the time `now` with the first cascade. Binds the first bindable node of each type outside
  /// Inlines (4.6.10). Starts the time-dependent nodes that are active at `now` (4.6.9). Call it once.
  void start(double now);
  /// Advances the time to `now` and delivers all resulting events. An earlier `now` does not turn time back.
  void step(double now);
  /// Returns the time of the next step that has work to do. This is now() while nodes run. Returns nullopt if only
  /// events from outside can cause work.
  [[nodiscard]] std::optional<double> next_time() const;
  [[nodiscard]] double now() const { return cascade_.now(); }

  /// Delivers an event from outside the world with the present timestamp, and all resulting events. `event_in` must be
  /// an eventIn or exposedField of the node's type, and the value must have its type. Returns false otherwise, if the
  /// scene is not part of the world, or if the budget is exhausted.
  bool send(const SceneGraph& scene, NodeId node, const InterfaceDeclaration& event_in, const FieldValue& value) {
    return cascade_.send(scene, node, event_in, value);
  }

  [[nodiscard]] EventBudget& budget() { return budget_; }
  [[nodiscard]] WorldScenes& scenes() { return scenes_; }
  [[nodiscard]] const WorldScenes& scenes() const { return scenes_; }
  [[nodiscard]] EventNodes& nodes() { return nodes_; }
  [[nodiscard]] RouteTable& routes() { return routes_; }
  [[nodiscard]] const RouteTable& routes() const { return routes_; }
  [[nodiscard]] EventCascade& cascade() { return cascade_; }
  [[nodiscard]] ChangeList& changes() { return changes_; }
  [[nodiscard]] BindableStacks& stacks() { return stacks_; }
  [[nodiscard]] const BindableStacks& stacks() const { return stacks_; }
  [[nodiscard]] TimerQueue& timers() { return timers_; }
  [[nodiscard]] NodeLifetime& lifetime() { return lifetime_; }
  [[nodiscard]] ScriptQueue& scripts() { return scripts_; }
  [[nodiscard]] Placement& placement() { return placement_; }
  [[nodiscard]] WorldViewer& viewer() { return viewer_; }
  [[nodiscard]] Pointing& pointing() { return pointing_; }
  [[nodiscard]] WorldBrowser& browser() { return browser_; }
  [[nodiscard]] UrlLoads& loads() { return loads_; }
  [[nodiscard]] KeyDevice& keys() { return keys_; }
  [[nodiscard]] PlacedShapes& shapes() { return shapes_; }
  /// Returns the states of behaviours. EventNodes::state_of is the index of a node's state.
  [[nodiscard]] BehaviourStates& states() { return states_; }

  // The following functions are for behaviours. `event` is an index in Behaviour::events.

  template <class T>
  [[nodiscard]] const T& get(EventNode node, int event) const {
    return *std::get_if<T>(&nodes_.value_of(node, event));
  }
  /// Reports whether the event was sent with the present timestamp.
  [[nodiscard]] bool has_sent(EventNode node, int event) const;
  /// Sends an event from an eventOut, or sets an exposedField and sends its value.
  template <class T>
  void send(EventNode node, int event, T value) {
    if (FieldValue* place = cascade_.place_to_send(node, event)) *place = std::move(value);
  }

 private:
  EventBudget budget_;
  WorldScenes scenes_;
  EventNodes nodes_;
  RouteTable routes_;
  EventCascade cascade_;
  ChangeList changes_;
  BindableStacks stacks_;
  TimerQueue timers_;
  NodeLifetime lifetime_;
  ScriptQueue scripts_;
  Placement placement_;
  WorldViewer viewer_;
  Pointing pointing_;
  WorldBrowser browser_;
  UrlLoads loads_;
  KeyDevice keys_;
  PlacedShapes shapes_;
  BehaviourStates states_;
};

}  // namespace gs::vrml
