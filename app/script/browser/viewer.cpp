#include "app/script/browser/browser_natives.h"

// Viewer, window and keys of the Browser object (Blaxxun Contact).
namespace gs::app::script {
namespace {

constexpr int kLengthOfPosition = 3, kLengthOfOrientation = 4;

bool give_tuple(JSContext* context, vrml::FieldType type, const double* c, JS::MutableHandleValue value) {
  JSObject* const made = make_tuple(context, type, c);
  value.setObjectOrNull(made);
  return made != nullptr;
}

// Converts a position or an orientation. Null and undefined mean that the viewer keeps it.
bool read_part(JSContext* context, JS::HandleValue value, vrml::FieldType type, vrml::FieldValue& field) {
  field = vrml::SFBool{false};
  return value.isNullOrUndefined() || to_field(context, value, type, 0, field);
}

bool move_viewer(JSContext* context, const JS::CallArgs& args, JS::HandleValue position, JS::HandleValue orientation) {
  Question question{Ask::move_viewer};
  args.rval().setUndefined();
  if (!read_part(context, position, vrml::FieldType::SFVec3f, question.value) ||
      !read_part(context, orientation, vrml::FieldType::SFRotation, question.second))
    return false;
  (void)world_of(context).view().ask(question);
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

const BrowserFacts& facts_of(JSContext* context) { return world_of(context).view().browser(); }

}  // namespace

bool get_viewpoint_position(JSContext* context, unsigned argc, JS::Value* vp) {
  return give_tuple(context, vrml::FieldType::SFVec3f, facts_of(context).position.data(),
                    JS::CallArgsFromVp(argc, vp).rval());
}

bool set_viewpoint_position(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  return move_viewer(context, args, args.get(0), JS::UndefinedHandleValue);
}

bool get_viewpoint_orientation(JSContext* context, unsigned argc, JS::Value* vp) {
  return give_tuple(context, vrml::FieldType::SFRotation, facts_of(context).orientation.data(),
                    JS::CallArgsFromVp(argc, vp).rval());
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
  const BrowserFacts facts = facts_of(context);
  args.rval().setUndefined();
  return fill(context, args.get(0), facts.position.data(), kLengthOfPosition) &&
         fill(context, args.get(1), facts.orientation.data(), kLengthOfOrientation);
}

bool get_bound_viewpoint(JSContext* context, unsigned argc, JS::Value* vp) {
  return node_to_value(context, world_of(context).view().ask({Ask::bound_viewpoint}).node,
                       JS::CallArgsFromVp(argc, vp).rval());
}

bool get_window_width(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(facts_of(context).width));
  return true;
}

bool get_window_height(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(facts_of(context).height));
  return true;
}

bool get_window_aspect(JSContext* context, unsigned argc, JS::Value* vp) {
  constexpr double kUsual = 4.0 / 3;  // before there is a viewport
  const double width = facts_of(context).width, height = facts_of(context).height;
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(height > 0 ? width / height : kUsual));
  return true;
}

bool get_window_size(JSContext* context, unsigned argc, JS::Value* vp) {
  const double c[] = {facts_of(context).width, facts_of(context).height};
  return give_tuple(context, vrml::FieldType::SFVec2f, c, JS::CallArgsFromVp(argc, vp).rval());
}

bool get_event_mask(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setInt32(facts_of(context).event_mask);
  return true;
}

bool set_event_mask(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::int32_t mask = 0;
  args.rval().setUndefined();
  if (!JS::ToInt32(context, args.get(0), &mask)) return false;
  (void)world_of(context).view().ask({Ask::set_event_mask, {}, {}, static_cast<std::uint32_t>(mask)});
  return true;
}

bool is_key_pressed(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::int32_t key = 0;
  if (!JS::ToInt32(context, args.get(0), &key)) return false;
  args.rval().setBoolean(world_of(context).view().ask({Ask::is_pressed, {}, {}, static_cast<std::uint32_t>(key)}).good);
  return true;
}

}  // namespace gs::app::script
