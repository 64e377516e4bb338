#include "app/script/browser/browser_natives.h"
#include "app/script/run_time_nodes.h"

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

const vrml::NodeType& navigation_type() { return vrml::built_in_node_type(vrml::NodeKind::navigation_info); }

/// NavigationInfo on which the methods act; its scene is null if there is none.
vrml::NodePlace navigation_node(World& world) {
  vrml::Execution& execution = world.execution();
  const vrml::NodeChange bound = execution.stacks().bound(navigation_type());
  if (bound.scene) return {bound.scene, bound.node};
  const vrml::NodePlace made = execution.browser().made_navigation();
  const bool lives = made.scene && execution.scenes().has(made.scene) && made.scene->contains(made.node);
  return lives ? made : vrml::NodePlace{};
}

// Returns the value of a field after the events of the running function. Returns the default if no NavigationInfo is
// bound, or if the program may not read it.
vrml::FieldValue navigation_value(JSContext* context, const char* field) {
  World& world = world_of(context);
  const vrml::InterfaceDeclaration& declaration = *navigation_type().find_field(field);
  const vrml::NodePlace at = navigation_node(world);
  if (!at.scene || !may_read(context, at.scene->node(at.node))) return declaration.initial;
  if (const vrml::FieldValue* const posted = world.calls().posted().find(*at.scene, at.node, declaration))
    return *posted;
  return at.scene->node(at.node).values[declaration.slot];
}

// Sends an event to a NavigationInfo at the end of the running function. The Script needs no directOutput, because the
// browser sends the event for it.
bool send_navigation(JSContext* context, const vrml::NodePlace& at, const char* event, vrml::FieldValue value) {
  World& world = world_of(context);
  return world.calls().posted().add(context, *world.execution().scenes().own(*at.scene), at.node,
                                    *navigation_type().find_event_in(event), std::move(value));
}

// Makes a NavigationInfo like the present navigation.
bool make_navigation(JSContext* context, vrml::NodePlace& at) {
  World& world = world_of(context);
  vrml::Execution& execution = world.execution();
  vrml::SceneGraph& scene = *world.calls().running().scene;
  const vrml::BrowserView& view = execution.browser().view();
  const auto plain = [](char c) { return c >= 'A' && c <= 'Z'; };
  const bool known = !view.mode.empty() && std::all_of(view.mode.begin(), view.mode.end(), plain);
  const std::string text = "NavigationInfo { type [ \"" + (known ? view.mode : std::string("WALK")) +
                           "\" \"ANY\" ] speed " + std::to_string(view.speed) + " }";
  Diagnostics diagnostics;
  const vrml::RunTimeNodes made =
      make_nodes(execution, scene, "Browser", text, diagnostics, &text_of_program(world.calls().running()));
  if (made.roots.empty()) return fail(context, "not enough memory for a NavigationInfo");
  at = {&scene, made.roots.front()};
  execution.lifetime().hold(scene, at.node);
  execution.browser().set_made_navigation(at);
  return true;
}

bool set_navigation(JSContext* context, const char* field, vrml::FieldValue value) {
  World& world = world_of(context);
  if (!world.calls().may_act()) return true;
  vrml::NodePlace at = navigation_node(world);
  if (!at.scene && !make_navigation(context, at)) return false;
  // A NavigationInfo that was made earlier may have lost its place, for example by replaceWorld().
  if (!world.execution().stacks().bound(navigation_type()).scene &&
      !send_navigation(context, at, "set_bind", vrml::SFBool{true}))
    return false;
  return send_navigation(context, at, field, std::move(value));
}

double measure(JSContext* context, Measure wanted) {
  const MeasureRow& row = kMeasures[static_cast<std::size_t>(wanted)];
  const vrml::FieldValue value = navigation_value(context, row.field);
  if (row.element < 0) return std::get<vrml::SFFloat>(value);
  const auto& sizes = std::get<vrml::MFFloat>(value);
  const auto& usual = std::get<vrml::MFFloat>(navigation_type().find_field(row.field)->initial);
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
  return make_string(context, world_of(context).execution().browser().mode(), JS::CallArgsFromVp(argc, vp).rval());
}

bool set_navigation_mode(JSContext* context, unsigned argc, JS::Value* vp) {
  constexpr std::size_t kMaxMode = 32;
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::string mode;
  args.rval().setUndefined();
  if (!cut_text_of_value(context, args.get(0), kMaxMode, mode)) return false;
  std::transform(mode.begin(), mode.end(), mode.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  world_of(context).execution().browser().choose_mode(mode);
  return true;
}

}  // namespace gs::app::script
