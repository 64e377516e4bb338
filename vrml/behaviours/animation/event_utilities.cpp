#include "vrml/behaviours/animation/interpolation.h"
#include "vrml/events/execution.h"

#include <algorithm>

// Nodes of the component EventUtilities (X3D clause 30).
namespace gs::vrml {
namespace {

struct FilterEvents {
  enum : int { set_boolean, input_false, input_negate, input_true };
};

bool filter_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != FilterEvents::set_boolean) return true;
  const SFBool given = std::get<SFBool>(value);
  execution.send(node, given ? FilterEvents::input_true : FilterEvents::input_false, given);
  execution.send(node, FilterEvents::input_negate, SFBool{!given});
  return false;
}

struct ToggleEvents {
  enum : int { set_boolean, toggle };
};

bool toggle_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != ToggleEvents::set_boolean) return true;
  if (std::get<SFBool>(value))
    execution.send(node, ToggleEvents::toggle, SFBool{!execution.get<SFBool>(node, ToggleEvents::toggle)});
  return false;
}

struct TriggerEvents {
  enum : int { set, trigger, key };
};

bool boolean_trigger(Execution& execution, EventNode node, int event, const FieldValue&) {
  if (event == TriggerEvents::set) execution.send(node, TriggerEvents::trigger, SFBool{true});
  return true;
}

bool integer_trigger(Execution& execution, EventNode node, int event, const FieldValue&) {
  if (event == TriggerEvents::set)
    execution.send(node, TriggerEvents::trigger, SFInt32{execution.get<SFInt32>(node, TriggerEvents::key)});
  return true;
}

bool time_trigger(Execution& execution, EventNode node, int event, const FieldValue&) {
  if (event == TriggerEvents::set) execution.send(node, TriggerEvents::trigger, SFTime{execution.now()});
  return true;
}

// ---- Sequencers

struct SequencerEvents {
  enum : int { set_fraction, next, previous, key, key_value, value_changed };
};

// Handles set_fraction, next and previous. EventNodes::state_of is 1 + the index of the last value sent; 0 means none.
template <class T>
bool sequencer_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event > SequencerEvents::previous) return true;
  const Array<T>& values = execution.get<Array<T>>(node, SequencerEvents::key_value);
  std::uint32_t& last = execution.nodes().state_of(node);
  std::size_t index = 0;
  if (event == SequencerEvents::set_fraction) {
    const MFFloat& keys = execution.get<MFFloat>(node, SequencerEvents::key);
    const std::size_t count = std::min(keys.size(), values.size());
    if (count == 0) return false;
    index = find_key(keys.span().first(count), std::get<SFFloat>(value)).first;
  } else {
    // The first value follows the last one.
    if (!std::get<SFBool>(value) || values.empty()) return false;
    const std::size_t count = values.size(), now = std::min<std::size_t>(last, count);
    index = event == SequencerEvents::next ? now % count : (now == 0 ? count - 1 : (now + count - 2) % count);
  }
  last = static_cast<std::uint32_t>(index + 1);
  execution.send(node, SequencerEvents::value_changed, T(values[index]));
  return false;
}

constexpr std::array<std::string_view, Behaviour::kMaxEvents> kSequencerEvents = {
    "set_fraction", "next", "previous", "key", "keyValue", "value_changed"};

}  // namespace

const Behaviour kBooleanFilterBehaviour = {.events = {"set_boolean", "inputFalse", "inputNegate", "inputTrue"},
                                           .on_event = filter_event};
const Behaviour kBooleanToggleBehaviour = {.events = {"set_boolean", "toggle"}, .on_event = toggle_event};
const Behaviour kBooleanTriggerBehaviour = {.events = {"set_triggerTime", "triggerTrue"}, .on_event = boolean_trigger};
const Behaviour kIntegerTriggerBehaviour = {.events = {"set_boolean", "triggerValue", "integerKey"},
                                            .on_event = integer_trigger};
const Behaviour kTimeTriggerBehaviour = {.events = {"set_boolean", "triggerTime"}, .on_event = time_trigger};
const Behaviour kBooleanSequencerBehaviour = {.events = kSequencerEvents, .on_event = sequencer_event<SFBool>};
const Behaviour kIntegerSequencerBehaviour = {.events = kSequencerEvents, .on_event = sequencer_event<SFInt32>};

}  // namespace gs::vrml
