#include "vrml/behaviours/animation/interpolation.h"
#include "vrml/event_model/states.h"
#include "vrml/events/execution.h"
#include "vrml/tessellation/nurbs.h"

#include <algorithm>
#include <utility>

namespace gs::vrml {
namespace {

struct InterpolatorEvents {
  enum : int { set_fraction, key_value, value_changed, key };
};

// Evaluates an interpolator with one value per key (6.10, 6.32, 6.37, 6.39).
template <class T, T (*between)(const T&, const T&, float)>
bool set_fraction(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != InterpolatorEvents::set_fraction) return true;
  const MFFloat& keys = execution.get<MFFloat>(node, InterpolatorEvents::key);
  const Array<T>& values = execution.get<Array<T>>(node, InterpolatorEvents::key_value);
  const std::size_t count = std::min(keys.size(), values.size());
  if (count == 0) return false;
  const KeyPlace place = find_key(keys.span().first(count), std::get<SFFloat>(value));
  execution.send(
      node, InterpolatorEvents::value_changed,
      place.part == 0 ? values[place.first] : between(values[place.first], values[place.second], place.part));
  return false;
}

// Returns the value of value_changed before the first set_fraction: the first element of keyValue (4.6.8).
template <class T>
bool first_value(Execution& execution, EventNode node, FieldValue& value) {
  const Array<T>& values = execution.get<Array<T>>(node, InterpolatorEvents::key_value);
  if (values.empty()) return false;
  value = values[0];
  return true;
}

template <class T>
bool first_list(Execution& execution, EventNode node, FieldValue& value) {
  const MFFloat& keys = execution.get<MFFloat>(node, InterpolatorEvents::key);
  const Array<T>& values = execution.get<Array<T>>(node, InterpolatorEvents::key_value);
  const std::size_t count = keys.empty() ? 0 : values.size() / keys.size();
  if (count == 0 || !execution.budget().spend(count) || !execution.nodes().afford_most(node, 2 * count * sizeof(T)))
    return false;
  value = Array<T>(values.span().first(count));
  return true;
}

StatePool<MFVec3f>& spares_of(BehaviourStates& states, const SFVec3f*) { return states.spares; }
StatePool<MFVec2f>& spares_of(BehaviourStates& states, const SFVec2f*) { return states.flat_spares; }

// Evaluates an interpolator with a list of values per key (6.13, 6.31). Alternates between two arrays, because the last
// array sent may share storage with the fields that received it. The previous array no longer shares storage.
template <class T, T (*between)(const T&, const T&, float)>
bool set_fraction_of_list(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != InterpolatorEvents::set_fraction) return true;
  const MFFloat& keys = execution.get<MFFloat>(node, InterpolatorEvents::key);
  const Array<T>& values = execution.get<Array<T>>(node, InterpolatorEvents::key_value);
  const std::size_t count = keys.empty() ? 0 : values.size() / keys.size();
  if (count == 0 || !execution.budget().spend(count) || execution.has_sent(node, InterpolatorEvents::value_changed))
    return false;
  const KeyPlace place = find_key(keys.span(), std::get<SFFloat>(value));
  std::uint32_t& state = execution.nodes().state_of(node);
  auto& spares = spares_of(execution.states(), static_cast<T*>(nullptr));
  if (state == 0) state = spares.take();
  Array<T>& spare = spares[state];
  if (!execution.nodes().afford_most(node, 2 * count * sizeof(T))) return false;
  if (spare.shared()) spare = {};
  spare.resize(count);
  T* to = spare.mutable_data();
  const T* first = values.data() + place.first * count;
  const T* second = values.data() + place.second * count;
  for (std::size_t i = 0; i < count; ++i) to[i] = place.part == 0 ? first[i] : between(first[i], second[i], place.part);
  if (FieldValue* out = execution.cascade().place_to_send(node, InterpolatorEvents::value_changed))
    std::swap(*std::get_if<Array<T>>(out), spare);
  return false;
}

template <class T>
void list_is_removed(Execution& execution, EventNode node) {
  spares_of(execution.states(), static_cast<T*>(nullptr)).give_back(execution.nodes().state_of(node));
}

// Interface of an interpolator along a NURBS curve (Amendment 1). The field `dimension` is the number of control
// points; 0 means that all values of keyValue are control points.
struct NurbsEvents {
  enum : int { set_fraction, key_value, value_changed, key_weight, knot, order, dimension };
};
bool set_fraction_of_curve(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != NurbsEvents::set_fraction) return true;
  const MFVec3f& points = execution.get<MFVec3f>(node, NurbsEvents::key_value);
  const MFFloat& knots = execution.get<MFFloat>(node, NurbsEvents::knot);
  const SFInt32 dimension = execution.get<SFInt32>(node, NurbsEvents::dimension);
  const std::size_t count =
      dimension > 0 ? std::min(static_cast<std::size_t>(dimension), points.size()) : points.size();
  if (!execution.budget().spend(knots.size())) return false;
  const auto axis = NurbsAxis::make(count, execution.get<SFInt32>(node, NurbsEvents::order), knots.span());
  if (!axis) return false;
  execution.send(
      node, NurbsEvents::value_changed,
      nurbs_point(*axis, points, execution.get<MFFloat>(node, NurbsEvents::key_weight), std::get<SFFloat>(value)));
  return false;
}

constexpr std::array<std::string_view, Behaviour::kMaxEvents> kInterpolatorEvents = {"set_fraction", "keyValue",
                                                                                     "value_changed", "key"};

}  // namespace

const Behaviour kColorInterpolatorBehaviour = {.events = kInterpolatorEvents,
                                               .on_event = set_fraction<SFColor, between_colors>,
                                               .unsent_value = first_value<SFColor>};
const Behaviour kCoordinateInterpolatorBehaviour = {.events = kInterpolatorEvents,
                                                    .on_event = set_fraction_of_list<SFVec3f, between_points>,
                                                    .on_remove = list_is_removed<SFVec3f>,
                                                    .unsent_value = first_list<SFVec3f>};
const Behaviour kNormalInterpolatorBehaviour = {.events = kInterpolatorEvents,
                                                .on_event = set_fraction_of_list<SFVec3f, between_normals>,
                                                .on_remove = list_is_removed<SFVec3f>,
                                                .unsent_value = first_list<SFVec3f>};
const Behaviour kOrientationInterpolatorBehaviour = {.events = kInterpolatorEvents,
                                                     .on_event = set_fraction<SFRotation, between_rotations>,
                                                     .unsent_value = first_value<SFRotation>};
const Behaviour kPositionInterpolatorBehaviour = {.events = kInterpolatorEvents,
                                                  .on_event = set_fraction<SFVec3f, between_points>,
                                                  .unsent_value = first_value<SFVec3f>};
const Behaviour kScalarInterpolatorBehaviour = {.events = kInterpolatorEvents,
                                                .on_event = set_fraction<SFFloat, between_numbers>,
                                                .unsent_value = first_value<SFFloat>};
const Behaviour kCoordinateInterpolator2DBehaviour = {.events = kInterpolatorEvents,
                                                      .on_event = set_fraction_of_list<SFVec2f, between_flat_points>,
                                                      .on_remove = list_is_removed<SFVec2f>,
                                                      .unsent_value = first_list<SFVec2f>};
const Behaviour kPositionInterpolator2DBehaviour = {.events = kInterpolatorEvents,
                                                    .on_event = set_fraction<SFVec2f, between_flat_points>,
                                                    .unsent_value = first_value<SFVec2f>};
const Behaviour kNurbsPositionInterpolatorBehaviour = {
    .events = {"set_fraction", "keyValue", "value_changed", "keyWeight", "knot", "order", "dimension"},
    .on_event = set_fraction_of_curve};

}  // namespace gs::vrml
