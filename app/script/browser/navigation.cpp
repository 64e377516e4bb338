#include "app/script/browser/browser_natives.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

// Navigation of the Browser object (Blaxxun Contact). Its numbers are those of the bound NavigationInfo (VRML97 6.29).
namespace gs::app::script {
namespace {

/// Place of a number in a NavigationInfo.
struct MeasureRow {
  const char* field;
  int element;  // index in an MFFloat; -1 for an SFFloat
};
constexpr MeasureRow kMeasures[] = {
    {"avatarSize", 0}, {"avatarSize", 1}, {"avatarSize", 2}, {"visibilityLimit", -1}, {"speed", -1}};

// Returns the default of a field.
const vrml::FieldValue& usual_value(const char* field) {
  return vrml::built_in_node_type(vrml::NodeKind::navigation_info).find_field(field)->initial;
}

// Returns the value of a field after the events of the running function. Returns the default if no NavigationInfo is
// bound, or if the program may not read it.
vrml::FieldValue navigation_value(JSContext* context, const char* field) {
  World& world = world_of(context);
  Question question{Ask::navigation};
  question.text = field;
  const Answer answer = world.view().ask(question);
  if (answer.good && answer.node)
    if (const vrml::FieldValue* const posted = world.calls().posted().find(answer.node, answer.place)) return *posted;
  const vrml::FieldValue& usual = usual_value(field);
  return answer.good && answer.value.index() == usual.index() ? answer.value : usual;
}

// Sends an event to the NavigationInfo `node` at the end of the running function. The Script needs no directOutput,
// because the browser sends the event for it.
bool send_navigation(JSContext* context, const NodeRef& node, const vrml::NodeType& type, const char* event,
                     vrml::FieldValue value) {
  const vrml::InterfaceDeclaration* const declaration = type.find_event_in(event);
  for (std::uint32_t place = 0; declaration && place < type.interfaces.size(); ++place)
    if (&type.interfaces[place] == declaration)
      return world_of(context).calls().posted().add(context, node, place, *declaration, std::move(value));
  return true;
}

bool set_navigation(JSContext* context, const char* field, vrml::FieldValue value) {
  const Answer answer = world_of(context).view().ask({Ask::make_navigation});
  if (!answer.good) return answer.text.empty() || fail(context, answer.text);
  if (!answer.type) return true;
  // A NavigationInfo that was made earlier may have lost its place, for example by replaceWorld().
  if (answer.flag && !send_navigation(context, answer.node, *answer.type, "set_bind", vrml::SFBool{true})) return false;
  return send_navigation(context, answer.node, *answer.type, field, std::move(value));
}

double measure(JSContext* context, Measure wanted) {
  const MeasureRow& row = kMeasures[static_cast<std::size_t>(wanted)];
  const vrml::FieldValue value = navigation_value(context, row.field);
  if (row.element < 0) return std::get<vrml::SFFloat>(value);
  const auto& sizes = std::get<vrml::MFFloat>(value);
  const auto& usual = std::get<vrml::MFFloat>(usual_value(row.field));
  const auto place = static_cast<std::size_t>(row.element);
  return place < sizes.size() ? sizes[place] : usual[place];
}

}  // namespace

bool get_measure_of(JSContext* context, unsigned argc, JS::Value* vp, Measure wanted) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(measure(context, wanted)));
  return true;
}

bool set_measure_of(JSContext* context, unsigned argc, JS::Value* vp, Measure wanted) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double number = 0;
  args.rval().setUndefined();
  if (!JS::ToNumber(context, args.get(0), &number)) return false;
  if (!std::isfinite(static_cast<float>(number)) || number < 0) {
    warn(context, "sizes and speeds of the viewer are numbers from 0; not set");
    return true;
  }
  const MeasureRow& row = kMeasures[static_cast<std::size_t>(wanted)];
  if (row.element < 0) return set_navigation(context, row.field, vrml::SFFloat(number));
  vrml::MFFloat sizes;
  for (const Measure one : {Measure::distance, Measure::height, Measure::step})
    sizes.push_back(static_cast<float>(one == wanted ? number : measure(context, one)));
  return set_navigation(context, row.field, std::move(sizes));
}

bool get_z_near(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(measure(context, Measure::distance) / 2));
  return true;
}

bool get_z_far(JSContext* context, unsigned argc, JS::Value* vp) {
  constexpr double kFar = 1e5;  // metres, if the visibility is unlimited
  const double limit = measure(context, Measure::visibility);
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(limit > 0 ? limit : kFar));
  return true;
}

bool get_headlight(JSContext* context, unsigned argc, JS::Value* vp) {
  const vrml::FieldValue value = navigation_value(context, "headlight");
  JS::CallArgsFromVp(argc, vp).rval().setBoolean(std::get<vrml::SFBool>(value));
  return true;
}

bool set_headlight(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  args.rval().setUndefined();
  return set_navigation(context, "headlight", vrml::SFBool{JS::ToBoolean(args.get(0))});
}

bool get_navigation_mode(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, world_of(context).view().browser().mode, JS::CallArgsFromVp(argc, vp).rval());
}

bool set_navigation_mode(JSContext* context, unsigned argc, JS::Value* vp) {
  constexpr std::size_t kMaxMode = 32;
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Question question{Ask::choose_mode};
  std::string& mode = question.text;
  args.rval().setUndefined();
  if (!cut_text_of_value(context, args.get(0), kMaxMode, mode)) return false;
  std::transform(mode.begin(), mode.end(), mode.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  (void)world_of(context).view().ask(question);
  return true;
}

}  // namespace gs::app::script
