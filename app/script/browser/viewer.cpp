#include "app/script/browser/browser_natives.h"
#include "vrml/scene/values/transformation.h"

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <cmath>
#include <iterator>
#include <optional>

// Viewer, window and keys of the Browser object (Blaxxun Contact).
namespace gs::app::script {
namespace {

constexpr int kLengthOfPosition = 3, kLengthOfOrientation = 4;

void position_of(const glm::dmat4& viewer, double* c) {
  for (int i = 0; i < kLengthOfPosition; ++i) c[i] = viewer[3][i];
}

void orientation_of(const glm::dmat4& viewer, double* c) {
  const glm::dquat q = glm::normalize(glm::quat_cast(glm::dmat3(viewer)));
  const glm::dvec3 v(q.x, q.y, q.z);
  const double size = glm::length(v);
  c[0] = size > 0 ? v.x / size : 0;
  c[1] = size > 0 ? v.y / size : 0;
  c[2] = size > 0 ? v.z / size : 1;
  c[3] = 2 * std::atan2(size, q.w);
}

bool give_tuple(JSContext* context, vrml::FieldType type, const double* c, JS::MutableHandleValue value) {
  JSObject* const made = make_tuple(context, type, c);
  value.setObjectOrNull(made);
  return made != nullptr;
}

// Reads a position; leaves `position` empty if the value is undefined or null.
bool read_position(JSContext* context, JS::HandleValue value, std::optional<glm::dvec3>& position) {
  vrml::FieldValue field;
  if (value.isNullOrUndefined()) return true;
  if (!to_field(context, value, vrml::FieldType::SFVec3f, nullptr, field)) return false;
  position = glm::dvec3(std::get<vrml::SFVec3f>(field));
  return true;
}

bool read_orientation(JSContext* context, JS::HandleValue value, std::optional<glm::dquat>& orientation) {
  vrml::FieldValue field;
  if (value.isNullOrUndefined()) return true;
  if (!to_field(context, value, vrml::FieldType::SFRotation, nullptr, field)) return false;
  orientation = glm::quat_cast(vrml::rotation_matrix(std::get<vrml::SFRotation>(field)));
  return true;
}

bool move_viewer(JSContext* context, const JS::CallArgs& args, JS::HandleValue position, JS::HandleValue orientation) {
  std::optional<glm::dvec3> to;
  std::optional<glm::dquat> turned;
  args.rval().setUndefined();
  if (!read_position(context, position, to) || !read_orientation(context, orientation, turned)) return false;
  world_of(context).execution().browser().move_viewer(to, turned);
  return true;
}

// Sets the components of an SFVec3f or SFRotation that the program has passed. Ignores other values.
bool fill(JSContext* context, JS::HandleValue value, const double* c, int count) {
  vrml::FieldType type{};
  double before[kLengthOfOrientation] = {};
  if (!value.isObject() || !is_tuple(&value.toObject(), type, before)) return true;
  JS::RootedObject object(context, &value.toObject());
  for (int i = 0; i < count; ++i) {
    JS::RootedValue component(context, JS::DoubleValue(c[i]));
    if (!JS_SetElement(context, object, static_cast<std::uint32_t>(i), component)) return false;
  }
  return true;
}

const vrml::BrowserView& view_of(JSContext* context) { return world_of(context).execution().browser().view(); }

}  // namespace

bool get_viewpoint_position(JSContext* context, unsigned argc, JS::Value* vp) {
  double c[kLengthOfPosition];
  position_of(world_of(context).execution().browser().pose(), c);
  return give_tuple(context, vrml::FieldType::SFVec3f, c, JS::CallArgsFromVp(argc, vp).rval());
}

bool set_viewpoint_position(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  return move_viewer(context, args, args.get(0), JS::UndefinedHandleValue);
}

bool get_viewpoint_orientation(JSContext* context, unsigned argc, JS::Value* vp) {
  double c[kLengthOfOrientation];
  orientation_of(world_of(context).execution().browser().pose(), c);
  return give_tuple(context, vrml::FieldType::SFRotation, c, JS::CallArgsFromVp(argc, vp).rval());
}

bool set_viewpoint_orientation(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  return move_viewer(context, args, JS::UndefinedHandleValue, args.get(0));
}

bool set_viewpoint_by_value(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  return move_viewer(context, args, args.get(0), args.get(1));
}

bool get_viewpoint_by_value(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const glm::dmat4 viewer = world_of(context).execution().browser().pose();
  double position[kLengthOfPosition], orientation[kLengthOfOrientation];
  position_of(viewer, position);
  orientation_of(viewer, orientation);
  args.rval().setUndefined();
  return fill(context, args.get(0), position, kLengthOfPosition) &&
         fill(context, args.get(1), orientation, kLengthOfOrientation);
}

bool get_bound_viewpoint(JSContext* context, unsigned argc, JS::Value* vp) {
  const vrml::NodeChange bound =
      world_of(context).execution().stacks().bound(vrml::built_in_node_type(vrml::NodeKind::viewpoint));
  JSObject* const node = bound.scene ? object_of_node(context, *bound.scene, bound.node) : nullptr;
  JS::CallArgsFromVp(argc, vp).rval().setObjectOrNull(node);
  return node != nullptr || !bound.scene;
}

bool get_window_width(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(view_of(context).size.x));
  return true;
}

bool get_window_height(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(view_of(context).size.y));
  return true;
}

bool get_window_aspect(JSContext* context, unsigned argc, JS::Value* vp) {
  constexpr double kUsual = 4.0 / 3;  // before there is a viewport
  const glm::dvec2 size = view_of(context).size;
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(size.y > 0 ? size.x / size.y : kUsual));
  return true;
}

bool get_window_size(JSContext* context, unsigned argc, JS::Value* vp) {
  const double c[] = {view_of(context).size.x, view_of(context).size.y};
  return give_tuple(context, vrml::FieldType::SFVec2f, c, JS::CallArgsFromVp(argc, vp).rval());
}

bool get_event_mask(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setInt32(world_of(context).execution().browser().event_mask());
  return true;
}

bool set_event_mask(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::int32_t mask = 0;
  args.rval().setUndefined();
  if (!JS::ToInt32(context, args.get(0), &mask)) return false;
  world_of(context).execution().browser().set_event_mask(mask);
  return true;
}

bool is_key_pressed(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::int32_t key = 0;
  if (!JS::ToInt32(context, args.get(0), &key)) return false;
  args.rval().setBoolean(world_of(context).execution().browser().is_pressed(key));
  return true;
}

}  // namespace gs::app::script
