#include "app/script/browser/browser_natives.h"
#include "app/script/run_time_nodes.h"

#include <js/Object.h>

#include <string>
#include <variant>

// Browser.addRoute() and Browser.deleteRoute() (VRML97 4.12.10).
namespace gs::app::script {
namespace {

/// End of a ROUTE: a node, or the Browser object.
struct RouteEnd {
  vrml::SceneGraph* scene = nullptr;  // null if the value is no node of the world
  vrml::NodeId node;
  bool is_browser = false;
};

bool route_end(JSContext* context, JS::HandleValue value, RouteEnd& end) {
  if (!value.isObject()) return true;
  JS::RootedObject library(context, library_of(context).global);
  JS::RootedValue browser(context);
  if (!JS_GetProperty(context, library, "Browser", &browser)) return false;
  end.is_browser = browser.isObject() && &browser.toObject() == &value.toObject();
  if (const NodeBox* const box = node_of(&value.toObject())) end = {box->live_scene(), box->id, false};
  return true;
}

// Replaces the Browser object by the browser's node in the scene of the other end.
bool take_browser(JSContext* context, RouteEnd& end, const RouteEnd& other) {
  if (!end.is_browser) return true;
  if (!other.scene) return fail(context, "expected a node at the other end of the ROUTE");
  end.scene = other.scene;
  end.node = world_of(context).execution().browser().node_in(*end.scene);
  return end.node ? true : fail(context, "not enough memory for the ROUTE");
}

bool change_route(JSContext* context, const JS::CallArgs& args, bool add) {
  World& world = world_of(context);
  RouteEnd from, to;
  std::string out, in;
  args.rval().setUndefined();
  if (!route_end(context, args.get(0), from) || !route_end(context, args.get(2), to)) return false;
  if (!text_of_value(context, args.get(1), out) || !text_of_value(context, args.get(3), in)) return false;
  if (!world.calls().may_act()) return true;
  if (!take_browser(context, from, to) || !take_browser(context, to, from)) return false;
  vrml::SceneGraph* const scene = from.scene;
  if (!scene || to.scene != scene || !scene->contains(from.node) || !scene->contains(to.node))
    return fail(context, "expected two nodes of one file");
  const auto found = route_between(*scene, from.node, out, to.node, in);
  if (const auto* const why = std::get_if<std::string>(&found)) return fail(context, *why);
  const vrml::Route& route = std::get<vrml::Route>(found);
  // Adding a ROUTE lets the target read values of the source, and may replace the program of a Script. Both need
  // permission. Every program can read the values that the browser's node receives. The values that it sends belong to
  // no file.
  const vrml::Node &source = scene->node(from.node), &target = scene->node(to.node);
  const bool same_source = !to.is_browser && source.text->source() == target.text->source();
  if (add && !from.is_browser && !same_source && !may_read(context, source)) return true;
  if (add && sets_program(*target.type, *route.event_in) && !may_read(context, target)) return true;
  // Adding a ROUTE that exists already has no effect (4.10.2).
  if (add)
    (void)world.execution().routes().add(*scene, route);
  else
    (void)world.execution().routes().remove(*scene, route);
  return true;
}

}  // namespace

bool add_route(JSContext* context, unsigned argc, JS::Value* vp) {
  return change_route(context, JS::CallArgsFromVp(argc, vp), true);
}

bool delete_route(JSContext* context, unsigned argc, JS::Value* vp) {
  return change_route(context, JS::CallArgsFromVp(argc, vp), false);
}

}  // namespace gs::app::script
