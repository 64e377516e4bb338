#include "vrml/behaviours/animation/follower_values.h"
#include "vrml/events/execution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

// Chasers and dampers (X3D clause 39). A follower runs only during a transition.
namespace gs::vrml {
namespace {

struct Follower {
  enum : int {
    set_destination,
    set_value,
    initial_destination,
    initial_value,
    is_active,
    value_changed,
    duration,
    order = duration,
    tau,
    tolerance
  };
};

FollowerState* follower_state(Execution& execution, EventNode node) {
  const std::uint32_t state = execution.nodes().state_of(node);
  return state == 0 ? nullptr : &execution.states().followers[state];
}

// Draws memory for `lists` lists of the size of `values`, and work for one evaluation.
bool afford_values(Execution& execution, EventNode node, const FollowerValues& values, std::size_t lists) {
  return execution.nodes().afford_most(node, (values.size() + 1) * lists * sizeof(glm::dvec4)) &&
         execution.budget().spend((values.size() + 1) * lists);
}

template <class Space>
void send_follower(Execution& execution, EventNode node, const FollowerValues& values) {
  execution.send(node, Follower::value_changed, Space::value_of(values));
}

// Starts or ends a transition.
void set_transition(Execution& execution, EventNode node, bool active) {
  execution.timers().run(node, active);
  if (active != execution.get<SFBool>(node, Follower::is_active))
    execution.send(node, Follower::is_active, SFBool{active});
}

void take_follower(Execution& execution, EventNode node) {
  auto& followers = execution.states().followers;
  if (!followers.has_spare() && !execution.budget().afford(sizeof(FollowerState))) return;
  execution.nodes().state_of(node) = followers.take();
  execution.timers().look_again(node);
}

// ---- Chasers: the output is the sum of the responses to all changes of the destination during the last `duration`
// seconds (39.3.1).

// Returns the response to a step of the destination, `part` of the duration after it.
double step_response(double part) {
  return part >= 1 ? 1 : !(part > 0) ? 0 : 0.5 - 0.5 * std::cos(part * std::numbers::pi);
}

double chaser_duration(Execution& execution, EventNode node) {
  const double duration = execution.get<SFTime>(node, Follower::duration);
  return duration > 0 && std::isfinite(duration) ? duration : 0;
}

// Adds a destination. Destinations that follow closely replace each other, so that the list has a maximum length.
template <class Space>
void add_destination(Execution& execution, EventNode node, FollowerState& state, FollowerValues values) {
  fit<Space>(state.base, values);
  for (FollowerState::Step& step : state.steps) fit<Space>(step.to, values);
  const double now = execution.now(), shortest = chaser_duration(execution, node) / FollowerState::kMaxSteps;
  if (!state.steps.empty() && now - state.steps.back().time < shortest) {
    state.steps.back().to = std::move(values);
  } else {
    state.steps.push_back({now, std::move(values)});
  }
}

// Takes the initial values before the first event or step.
template <class Space>
void begin_chaser(Execution& execution, EventNode node, FollowerState& state) {
  if (std::exchange(state.begun, true)) return;
  FollowerValues first = Space::values_of(execution.nodes().value_of(node, Follower::initial_value));
  FollowerValues destination = Space::values_of(execution.nodes().value_of(node, Follower::initial_destination));
  if (!afford_values(execution, node, first, 2) || !afford_values(execution, node, destination, 2)) return;
  state.base = std::move(first);
  if (state.base == destination) return;
  add_destination<Space>(execution, node, state, std::move(destination));
  set_transition(execution, node, true);
}

template <class Space>
void chase(Execution& execution, EventNode node) {
  FollowerState* const state = follower_state(execution, node);
  if (!state) return;
  if (!state->begun) return begin_chaser<Space>(execution, node, *state);
  if (!execution.nodes()[node].running) return;
  if (!afford_values(execution, node, state->base, state->steps.size() + 2)) return;
  const double now = execution.now(), duration = chaser_duration(execution, node);
  const auto part = [&](const FollowerState::Step& step) { return duration > 0 ? (now - step.time) / duration : 1.0; };
  std::size_t over = 0;
  while (over < state->steps.size() && part(state->steps[over]) >= 1) state->base = state->steps[over++].to;
  state->steps.erase(state->steps.begin(), state->steps.begin() + static_cast<std::ptrdiff_t>(over));
  FollowerValues made = state->base;
  const FollowerValues* from = &state->base;
  for (const FollowerState::Step& step : state->steps) {
    add_change<Space>(made, *from, step.to, step_response(part(step)));
    from = &step.to;
  }
  send_follower<Space>(execution, node, made);
  if (state->steps.empty() && !execution.has_sent(node, Follower::is_active)) set_transition(execution, node, false);
}

template <class Space>
bool chaser_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  FollowerState* const state = follower_state(execution, node);
  if (!state || event > Follower::set_value) return event > Follower::set_value;
  begin_chaser<Space>(execution, node, *state);
  FollowerValues values = Space::values_of(value);
  if (!afford_values(execution, node, values, FollowerState::kMaxSteps + 2)) return false;
  if (event == Follower::set_destination) {
    if (!state->steps.empty() ? state->steps.back().to == values : state->base == values) return false;
    add_destination<Space>(execution, node, *state, std::move(values));
  } else {
    // The output jumps to the value, and a new transition to the destination starts (39.3.3).
    FollowerValues destination = state->steps.empty() ? state->base : state->steps.back().to;
    state->base = std::move(values);
    state->steps.clear();
    add_destination<Space>(execution, node, *state, std::move(destination));
    send_follower<Space>(execution, node, state->base);
  }
  set_transition(execution, node, true);
  return false;
}

// ---- Dampers: `order` filters of first order, each of which processes the output of the one before (39.3.2).

constexpr int kMaxOrder = 5;

int damper_order(Execution& execution, EventNode node) {
  return std::clamp(execution.get<SFInt32>(node, Follower::order), 0, kMaxOrder);
}

// Reports whether the last filter and all filters before it have reached the destination.
template <class Space>
bool is_reached(Execution& execution, EventNode node, const FollowerState& state) {
  constexpr double kTolerance = 1e-4;
  const double given = execution.get<SFFloat>(node, Follower::tolerance);
  const double tolerance = given >= 0 ? given : kTolerance;
  return std::all_of(state.steps.begin(), state.steps.end(), [&](const FollowerState::Step& filter) {
    return distance<Space>(filter.to, state.base) <= tolerance;
  });
}

// Takes the initial values before the first event or step.
template <class Space>
void begin_damper(Execution& execution, EventNode node, FollowerState& state) {
  if (std::exchange(state.begun, true)) return;
  const FollowerValues first = Space::values_of(execution.nodes().value_of(node, Follower::initial_value));
  FollowerValues destination = Space::values_of(execution.nodes().value_of(node, Follower::initial_destination));
  if (!afford_values(execution, node, first, kMaxOrder) || !afford_values(execution, node, destination, kMaxOrder))
    return;
  const bool at_rest = first == destination;
  state.time = execution.now();
  for (int i = 0; i < damper_order(execution, node); ++i) {
    state.steps.push_back({0, first});
    fit<Space>(state.steps.back().to, destination);
  }
  state.base = std::move(destination);
  if (!at_rest) set_transition(execution, node, true);
}

// `base` is the destination, and steps[i].to is the output of filter i.
template <class Space>
void damp(Execution& execution, EventNode node) {
  FollowerState* const state = follower_state(execution, node);
  if (!state) return;
  if (!state->begun) return begin_damper<Space>(execution, node, *state);
  if (!execution.nodes()[node].running) return;
  if (!afford_values(execution, node, state->base, state->steps.size() + 1)) return;
  const double now = execution.now(), tau = execution.get<SFTime>(node, Follower::tau);
  const double passed = now - std::exchange(state->time, now);
  const double kept = tau > 0 ? std::exp(-passed / tau) : 0;
  const FollowerValues* input = &state->base;
  for (FollowerState::Step& filter : state->steps) {
    approach<Space>(filter.to, *input, 1 - kept);
    input = &filter.to;
  }
  const bool over = is_reached<Space>(execution, node, *state);
  if (over)
    for (FollowerState::Step& filter : state->steps) filter.to = state->base;
  send_follower<Space>(execution, node, over ? state->base : *input);
  if (over && !execution.has_sent(node, Follower::is_active)) set_transition(execution, node, false);
}

template <class Space>
bool damper_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  FollowerState* const state = follower_state(execution, node);
  if (!state || event > Follower::set_value) return event > Follower::set_value;
  begin_damper<Space>(execution, node, *state);
  FollowerValues values = Space::values_of(value);
  if (!afford_values(execution, node, values, kMaxOrder + 1)) return false;
  if (event == Follower::set_destination) {
    if (state->base == values) return false;
    for (FollowerState::Step& filter : state->steps) fit<Space>(filter.to, values);
    state->base = std::move(values);
  } else {
    fit<Space>(state->base, values);
    for (FollowerState::Step& filter : state->steps) filter.to = values;
    send_follower<Space>(execution, node, values);
  }
  if (!execution.nodes()[node].running) state->time = execution.now();
  set_transition(execution, node, true);
  return false;
}

// ---- Rows

void follower_removed(Execution& execution, EventNode node) {
  execution.states().followers.give_back(execution.nodes().state_of(node));
}

bool follower_first_value(Execution& execution, EventNode node, FieldValue& value) {
  if (type_of(value) != type_of(execution.nodes().value_of(node, Follower::initial_value))) return false;
  value = execution.nodes().value_of(node, Follower::initial_value);
  return true;
}

template <class Space>
constexpr Behaviour chaser() {
  return {.events = {"set_destination", "set_value", "initialDestination", "initialValue", "isActive", "value_changed",
                     "duration"},
          .initialize = take_follower,
          .on_event = chaser_event<Space>,
          .on_time = chase<Space>,
          .on_remove = follower_removed,
          .unsent_value = follower_first_value};
}

template <class Space>
constexpr Behaviour damper() {
  return {.events = {"set_destination", "set_value", "initialDestination", "initialValue", "isActive", "value_changed",
                     "order", "tau", "tolerance"},
          .initialize = take_follower,
          .on_event = damper_event<Space>,
          .on_time = damp<Space>,
          .on_remove = follower_removed,
          .unsent_value = follower_first_value};
}

}  // namespace

constexpr Behaviour kColorChaserBehaviour = chaser<ColorSpace>(), kColorDamperBehaviour = damper<ColorSpace>();
constexpr Behaviour kCoordinateChaserBehaviour = chaser<ListSpace<SFVec3f>>(),
                    kCoordinateDamperBehaviour = damper<ListSpace<SFVec3f>>();
constexpr Behaviour kOrientationChaserBehaviour = chaser<OrientationSpace>(),
                    kOrientationDamperBehaviour = damper<OrientationSpace>();
constexpr Behaviour kPositionChaserBehaviour = chaser<PointSpace<SFVec3f>>(),
                    kPositionDamperBehaviour = damper<PointSpace<SFVec3f>>();
constexpr Behaviour kPositionChaser2DBehaviour = chaser<PointSpace<SFVec2f>>(),
                    kPositionDamper2DBehaviour = damper<PointSpace<SFVec2f>>();
constexpr Behaviour kScalarChaserBehaviour = chaser<ScalarSpace>(), kScalarDamperBehaviour = damper<ScalarSpace>();
constexpr Behaviour kTexCoordChaser2DBehaviour = chaser<ListSpace<SFVec2f>>(),
                    kTexCoordDamper2DBehaviour = damper<ListSpace<SFVec2f>>();

}  // namespace gs::vrml
