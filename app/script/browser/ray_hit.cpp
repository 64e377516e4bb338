#include "app/script/browser/browser_natives.h"

#include <js/Array.h>
#include <js/Object.h>

// Browser.computeRayHit() (Blaxxun Contact).
namespace gs::app::script {
namespace {

bool define_tuple(JSContext* context, JS::HandleObject hit, const char* name, vrml::FieldType type,
                  const double* components) {
  JS::RootedObject made(context, make_tuple(context, type, components));
  return made && JS_DefineProperty(context, hit, name, made, JSPROP_ENUMERATE);
}

}  // namespace

bool compute_ray_hit(JSContext* context, unsigned argc, JS::Value* vp) {
  constexpr std::size_t kNumbers = 8;  // point, normal, texture coordinate
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Question question{Ask::cast_ray};
  args.rval().setNull();
  if (!to_field(context, args.get(0), vrml::FieldType::SFVec3f, 0, question.value) ||
      !to_field(context, args.get(1), vrml::FieldType::SFVec3f, 0, question.second))
    return false;
  question.node = node_of_value(args.get(2));
  if (args.get(2).isObject() && node_of(&args[2].toObject()) && !question.node) return true;
  const Answer answer = world_of(context).view().ask(question);
  if (!answer.good) return true;
  double numbers[kNumbers] = {};
  JS::RootedValueVector path(context);
  for (std::size_t i = 0; i < answer.items.size(); ++i) {
    if (const auto* const number = std::get_if<double>(&answer.items[i]); number && i < kNumbers) numbers[i] = *number;
    const auto* const node = std::get_if<NodeRef>(&answer.items[i]);
    JSObject* const object = node ? object_of_node(context, *node) : nullptr;
    if (node && (!object || !path.append(JS::ObjectValue(*object)))) return false;
  }
  JS::RootedObject hit(context, JS_NewPlainObject(context));
  JS::RootedObject list(context, JS::NewArrayObject(context, JS::HandleValueArray(path)));
  if (!hit || !list || !JS_DefineProperty(context, hit, "hitPath", list, JSPROP_ENUMERATE)) return false;
  if (!define_tuple(context, hit, "hitPoint", vrml::FieldType::SFVec3f, numbers) ||
      !define_tuple(context, hit, "hitNormal", vrml::FieldType::SFVec3f, numbers + 3) ||
      !define_tuple(context, hit, "hitTexCoord", vrml::FieldType::SFVec2f, numbers + 6))
    return false;
  args.rval().setObject(*hit);
  return true;
}

}  // namespace gs::app::script
