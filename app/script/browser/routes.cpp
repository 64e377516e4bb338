#include "app/script/browser/browser_natives.h"

#include <string>
#include <utility>

// Browser.addRoute() and Browser.deleteRoute() (VRML97 4.12.10).
namespace gs::app::script {
namespace {

bool route_end(JSContext* context, JS::HandleValue value, NodeRef& node, bool& is_browser) {
  if (!value.isObject()) return true;
  JS::RootedObject library(context, library_of(context).global);
  JS::RootedValue browser(context);
  if (!JS_GetProperty(context, library, "Browser", &browser)) return false;
  is_browser = browser.isObject() && &browser.toObject() == &value.toObject();
  node = node_of_value(value);
  return true;
}

bool change_route(JSContext* context, const JS::CallArgs& args, bool add) {
  Question question{Ask::change_route};
  bool from_browser = false, to_browser = false;
  args.rval().setUndefined();
  if (!route_end(context, args.get(0), question.node, from_browser) ||
      !route_end(context, args.get(2), question.other, to_browser) ||
      !text_of_value(context, args.get(1), question.text) || !text_of_value(context, args.get(3), question.more))
    return false;
  question.flag = add;
  question.place = (from_browser ? kFromBrowser : 0U) | (to_browser ? kToBrowser : 0U);
  const Answer answer = world_of(context).view().ask(question);
  return answer.good || fail(context, answer.text);
}

}  // namespace

bool add_route(JSContext* context, unsigned argc, JS::Value* vp) {
  return change_route(context, JS::CallArgsFromVp(argc, vp), true);
}

bool delete_route(JSContext* context, unsigned argc, JS::Value* vp) {
  return change_route(context, JS::CallArgsFromVp(argc, vp), false);
}

}  // namespace gs::app::script
