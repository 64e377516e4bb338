#include "app/script/browser/browser_natives.h"

#include <js/Array.h>
#include <js/Object.h>

#include <optional>

// Browser.computeRayHit() (Blaxxun Contact).
namespace gs::app::script {
namespace {

bool define_tuple(JSContext* context, JS::HandleObject hit, const char* name, vrml::FieldType type,
                  std::initializer_list<double> components) {
  JS::RootedObject made(context, make_tuple(context, type, components.begin()));
  return made && JS_DefineProperty(context, hit, name, made, JSPROP_ENUMERATE);
}

bool point_of(JSContext* context, JS::HandleValue value, glm::dvec3& point) {
  vrml::FieldValue field;
  if (!to_field(context, value, vrml::FieldType::SFVec3f, nullptr, field)) return false;
  point = glm::dvec3(std::get<vrml::SFVec3f>(field));
  return true;
}

}  // namespace

bool compute_ray_hit(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  vrml::Execution& execution = world.execution();
  glm::dvec3 from(0), to(0);
  args.rval().setNull();
  if (!point_of(context, args.get(0), from) || !point_of(context, args.get(1), to)) return false;
  vrml::NodePlace below;
  if (const NodeBox* const box = args.get(2).isObject() ? node_of(&args[2].toObject()) : nullptr) {
    below = {box->live_scene(), box->id};
    if (!below.scene) return true;
  }
  const std::optional<vrml::RayHit> found = execution.browser().cast_ray(from, to, below);
  if (!found) return true;
  JS::RootedValueVector path(context);
  for (const auto& [scene, node] : found->path) {
    vrml::SceneGraph* const own = execution.scenes().own(*scene);
    if (!own || !own->contains(node)) return true;
    if (!may_read(context, own->node(node))) return true;
    JSObject* const object = object_of_node(context, *own, node);
    if (!object || !path.append(JS::ObjectValue(*object))) return false;
  }
  JS::RootedObject hit(context, JS_NewPlainObject(context));
  JS::RootedObject list(context, JS::NewArrayObject(context, JS::HandleValueArray(path)));
  if (!hit || !list || !JS_DefineProperty(context, hit, "hitPath", list, JSPROP_ENUMERATE)) return false;
  const glm::dvec3 &p = found->point, &n = found->normal;
  const glm::vec2& t = found->texture_coordinate;
  if (!define_tuple(context, hit, "hitPoint", vrml::FieldType::SFVec3f, {p.x, p.y, p.z}) ||
      !define_tuple(context, hit, "hitNormal", vrml::FieldType::SFVec3f, {n.x, n.y, n.z}) ||
      !define_tuple(context, hit, "hitTexCoord", vrml::FieldType::SFVec2f, {t.x, t.y}))
    return false;
  args.rval().setObject(*hit);
  return true;
}

}  // namespace gs::app::script
