#include "app/script/natives.h"
#include "app/script/run_time_nodes.h"
#include "app/script/script_world.h"

#include <js/Array.h>
#include <js/Conversions.h>
#include <js/Object.h>
#include <js/PropertySpec.h>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <cmath>
#include <utility>

// The Browser object (VRML97 4.12.10, C.6.3), print() and trace(), constants, and further functions that browsers of
// the VRML97 era offered.
namespace gs::app::script {
namespace {

constexpr std::size_t kMaxTold = 4096;  // max characters of a printed line and of a description

bool texts_argument(JSContext* context, const JS::CallArgs& args, unsigned index, std::vector<std::string>& texts) {
  if (index >= args.length() || args[index].isNullOrUndefined()) return true;
  vrml::FieldValue field;
  if (!to_field(context, args[index], vrml::FieldType::MFString, nullptr, field)) return false;
  for (const vrml::SFString& text : std::get<vrml::MFString>(field)) texts.push_back(text.str());
  return true;
}

ScriptRequest request_of(World& world, ScriptRequest::Kind kind) {
  ScriptRequest request;
  request.kind = kind;
  const Program& program = world.calls().running();
  request.origin = &text_of_program(program).origin();
  request.source = program.source;
  request.scene = program.scene;
  request.from_scene = program.scene;
  request.node = program.id;
  request.location = program.scene->node(program.id).location;
  return request;
}

// Adds a request, unless the program or the world ends.
void add_request(World& world, ScriptRequest request) {
  if (world.calls().may_act()) world.requests().add(std::move(request));
}

bool get_name(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, "GhostSpace", JS::CallArgsFromVp(argc, vp).rval());
}
bool get_version(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, GHOSTSPACE_VERSION, JS::CallArgsFromVp(argc, vp).rval());
}
bool get_speed(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(world_of(context).browser().speed));
  return true;
}
bool get_frame_rate(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(world_of(context).browser().frame_rate));
  return true;
}
bool get_world_url(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, world_of(context).browser().world_url, JS::CallArgsFromVp(argc, vp).rval());
}
bool get_time(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(world_of(context).execution().now()));
  return true;
}

bool replace_world(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  vrml::FieldValue nodes;
  args.rval().setUndefined();
  if (!world.calls().may_act()) return true;
  if (!to_field(context, args.get(0), vrml::FieldType::MFNode, world.calls().running().scene, nodes)) return false;
  if (!world.execution().lifetime().replace_world(std::get<vrml::MFNode>(nodes)))
    return fail(context, "replaceWorld expects nodes of the world's own file");
  return true;
}

bool create_from_string(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::string text;
  ListBox box;
  vrml::MFNode nodes;
  vrml::SceneGraph* scene = nullptr;
  if (!text_of_value(context, args.get(0), text)) return false;
  if (!nodes_from_text(context, text, nodes, scene)) return false;
  box.scene = scene;
  box.value = std::move(nodes);
  JSObject* const list = make_list(context, std::move(box), {});
  args.rval().setObjectOrNull(list);
  return list != nullptr;
}

bool create_from_url(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  ScriptRequest request = request_of(world, ScriptRequest::Kind::create_from_url);
  std::string event;
  args.rval().setUndefined();
  if (!texts_argument(context, args, 0, request.urls) || !text_of_value(context, args.get(2), event)) return false;
  const NodeBox* const box = args.get(1).isObject() ? node_of(&args[1].toObject()) : nullptr;
  vrml::SceneGraph* const scene = box ? box->live_scene() : nullptr;
  if (!scene) return fail(context, "createVrmlFromURL expects a node that receives the nodes");
  request.event_in = event_for_nodes(*scene, box->id, event);
  if (!request.event_in) return fail(context, "the node has no MFNode eventIn '" + event.substr(0, 80) + "'");
  request.scene = scene;
  request.node = box->id;
  add_request(world, std::move(request));
  return true;
}

template <bool kAdd>
bool change_route(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  args.rval().setUndefined();
  const NodeBox* const from = args.get(0).isObject() ? node_of(&args[0].toObject()) : nullptr;
  const NodeBox* const to = args.get(2).isObject() ? node_of(&args[2].toObject()) : nullptr;
  std::string out, in;
  if (!text_of_value(context, args.get(1), out) || !text_of_value(context, args.get(3), in)) return false;
  vrml::SceneGraph* const scene = from ? from->live_scene() : nullptr;
  if (!scene || !to || to->live_scene() != scene) return fail(context, "expected two nodes of one file");
  const auto found = route_between(*scene, from->id, out, to->id, in);
  if (const auto* const why = std::get_if<std::string>(&found)) return fail(context, *why);
  const vrml::Route& route = std::get<vrml::Route>(found);
  // Adding a ROUTE lets the target read values of the source, and may replace the program of a Script. Both need
  // permission.
  const vrml::Node &source = scene->node(from->id), &target = scene->node(to->id);
  const bool same_source = source.text->source() == target.text->source();
  if (kAdd && !same_source && !may_read(context, source)) return true;
  if (kAdd && sets_program(*target.type, *route.event_in) && !may_read(context, target)) return true;
  // Adding a ROUTE that exists already has no effect (4.10.2).
  if (kAdd)
    (void)world.execution().routes().add(*scene, route);
  else
    (void)world.execution().routes().remove(*scene, route);
  return true;
}

bool load_url(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  ScriptRequest request = request_of(world, ScriptRequest::Kind::load_url);
  args.rval().setUndefined();
  if (!texts_argument(context, args, 0, request.urls) || !texts_argument(context, args, 1, request.parameters))
    return false;
  add_request(world, std::move(request));
  return true;
}

template <ScriptRequest::Kind kKind>
bool tell_text(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  ScriptRequest request = request_of(world, kKind);
  args.rval().setUndefined();
  if (!cut_text_of_value(context, args.get(0), kMaxTold, request.text)) return false;
  add_request(world, std::move(request));
  return true;
}

bool print(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::string line, text;
  for (unsigned i = 0; i < args.length() && line.size() < kMaxTold; ++i) {
    if (!cut_text_of_value(context, args[i], kMaxTold, text)) return false;
    line += (i ? " " : "") + text;
  }
  world_of(context).messages().print(std::move(line));
  args.rval().setUndefined();
  return true;
}

// Accepts calls of functions that only other browsers implement.
bool do_nothing(JSContext*, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setUndefined();
  return true;
}
bool give_false(JSContext*, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setBoolean(false);
  return true;
}
bool give_true(JSContext*, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setBoolean(true);
  return true;
}
bool give_zero(JSContext*, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().setInt32(0);
  return true;
}
bool give_empty(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, "", JS::CallArgsFromVp(argc, vp).rval());
}

// ---- Position and orientation of the viewer (Blaxxun Contact)

bool viewpoint_position(JSContext* context, unsigned argc, JS::Value* vp) {
  const glm::dmat4 viewer = world_of(context).execution().viewer().pose();
  const double c[] = {viewer[3][0], viewer[3][1], viewer[3][2]};
  JSObject* const made = make_tuple(context, vrml::FieldType::SFVec3f, c);
  JS::CallArgsFromVp(argc, vp).rval().setObjectOrNull(made);
  return made != nullptr;
}
bool viewpoint_orientation(JSContext* context, unsigned argc, JS::Value* vp) {
  const glm::dmat4 viewer = world_of(context).execution().viewer().pose();
  const glm::dquat q = glm::normalize(glm::quat_cast(glm::dmat3(viewer)));
  const glm::dvec3 v(q.x, q.y, q.z);
  const double size = glm::length(v);
  const double c[] = {size > 0 ? v.x / size : 0, size > 0 ? v.y / size : 0, size > 0 ? v.z / size : 1,
                      2 * std::atan2(size, q.w)};
  JSObject* const made = make_tuple(context, vrml::FieldType::SFRotation, c);
  JS::CallArgsFromVp(argc, vp).rval().setObjectOrNull(made);
  return made != nullptr;
}

// ---- Functions without an object

// Implements parseInt(). Truncates a number directly: SpiderMonkey's own parseInt would parse the text of the number,
// which has an exponent if the number is very small or large.
bool parse_int(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  if (args.get(0).isNumber() && args.length() < 2) {
    args.rval().set(JS::NumberValue(std::trunc(args[0].toNumber()) + 0.0));
    return true;
  }
  JS::RootedObject global(context, library_of(context).global);
  JS::RootedValue result(context);
  if (!JS_CallFunctionName(context, global, "parseInt", JS::HandleValueArray(args), &result)) return false;
  args.rval().set(result);
  return true;
}

// Implements conversions such as SFFloat(x): returns the primitive value, or an object for it if called with `new`.
enum class Plain : std::uint8_t { number, integer, truth, text };
template <Plain kPlain>
bool plain(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  JS::RootedValue value(context);
  if constexpr (kPlain == Plain::truth) {
    value.setBoolean(JS::ToBoolean(args.get(0)));
  } else if constexpr (kPlain == Plain::text) {
    std::string text;
    if (args.length() > 0 && !text_of_value(context, args[0], text)) return false;
    if (!make_string(context, text, &value)) return false;
  } else {
    double number = 0;
    if (args.length() > 0 && !JS::ToNumber(context, args[0], &number)) return false;
    value.set(JS::NumberValue(kPlain == Plain::integer ? std::trunc(number) : number));
  }
  if (args.isConstructing()) {
    JSObject* const object = JS::ToObject(context, value);
    args.rval().setObjectOrNull(object);
    return object != nullptr;
  }
  args.rval().set(value);
  return true;
}

// Implements $copy(); see modern_text().
bool copy(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  args.rval().set(args.get(0));
  if (!args.get(0).isObject()) return true;
  JSObject* const object = &args[0].toObject();
  vrml::FieldType type{};
  double c[4] = {};
  JSObject* made = object;
  if (is_tuple(object, type, c)) {
    made = make_tuple(context, type, c);
  } else if (ListBox* const list = list_of(object)) {
    ListBox box;
    box.scene = list->scene;
    if (const vrml::FieldValue* const value = list_value(*list)) box.value = *value;
    made = make_list(context, std::move(box), {});
  } else if (is_image(object)) {
    vrml::PixelImage image;
    JS::RootedObject rooted(context, object);
    if (!image_of(context, rooted, image)) return false;
    made = make_image(context, image, {});
  }
  args.rval().setObjectOrNull(made);
  return made != nullptr;
}

// Implements $values(), which returns the values that `for each` loops over; see mended_text().
bool values(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  JS::RootedValueVector result(context);
  JS::RootedObject object(context, args.get(0).isObject() ? &args[0].toObject() : nullptr);
  JS::Rooted<JS::IdVector> names(context, JS::IdVector(context));
  if (object && !JS_Enumerate(context, object, &names)) return false;
  for (std::size_t i = 0; i < names.length(); ++i) {
    JS::RootedId name(context, names[i]);
    JS::RootedValue value(context);
    if (!JS_GetPropertyById(context, object, name, &value) || !result.append(value)) return false;
  }
  JSObject* const list = JS::NewArrayObject(context, JS::HandleValueArray(result));
  args.rval().setObjectOrNull(list);
  return list != nullptr;
}

bool random_number(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::DoubleValue(world_of(context).calls().clock().random()));
  return true;
}

const JSFunctionSpec kBrowser[] = {
    // Functions of Table C.1
    JS_FN("getName", get_name, 0, 0), JS_FN("getVersion", get_version, 0, 0), JS_FN("getCurrentSpeed", get_speed, 0, 0),
    JS_FN("getCurrentFrameRate", get_frame_rate, 0, 0), JS_FN("getWorldURL", get_world_url, 0, 0),
    JS_FN("replaceWorld", replace_world, 1, 0), JS_FN("createVrmlFromString", create_from_string, 1, 0),
    JS_FN("createVrmlFromURL", create_from_url, 3, 0), JS_FN("addRoute", change_route<true>, 4, 0),
    JS_FN("deleteRoute", change_route<false>, 4, 0), JS_FN("loadURL", load_url, 2, 0),
    JS_FN("setDescription", tell_text<ScriptRequest::Kind::description>, 1, 0),
    // Other spellings of these functions, which worlds and even the examples of Annex C use
    JS_FN("createVRMLFromString", create_from_string, 1, 0), JS_FN("createVRMLFromURL", create_from_url, 3, 0),
    JS_FN("createVrmlFromUrl", create_from_url, 3, 0), JS_FN("createX3DFromString", create_from_string, 1, 0),
    JS_FN("createX3DFromURL", create_from_url, 3, 0), JS_FN("loadUrl", load_url, 2, 0),
    JS_FN("getWorldUrl", get_world_url, 0, 0), JS_FN("print", print, 1, 0), JS_FN("println", print, 1, 0),
    // Functions of Cosmo Player, Blaxxun Contact and Cortona
    JS_FN("getTime", get_time, 0, 0), JS_FN("getCurrentTime", get_time, 0, 0),
    JS_FN("setViewpoint", tell_text<ScriptRequest::Kind::viewpoint>, 1, 0), JS_FN("showConsole", do_nothing, 0, 0),
    JS_FN("hideConsole", do_nothing, 0, 0), JS_FN("beginUpdate", do_nothing, 0, 0),
    JS_FN("endUpdate", do_nothing, 0, 0), JS_FN("setNavigationMode", do_nothing, 1, 0),
    JS_FN("setCollisionDetection", do_nothing, 1, 0), JS_FN("setGravity", do_nothing, 1, 0),
    JS_FN("setHeadlight", do_nothing, 1, 0), JS_FN("setCpuLoad", do_nothing, 1, 0),
    JS_FN("setLocalLightRadius", do_nothing, 1, 0), JS_FN("setBspMode", do_nothing, 1, 0),
    JS_FN("setUnloadDist", do_nothing, 1, 0), JS_FN("setLoadDist", do_nothing, 1, 0),
    JS_FN("setPrefetch", do_nothing, 1, 0), JS_FN("setRenderMode", do_nothing, 1, 0),
    JS_FN("setBrowserOption", do_nothing, 2, 0), JS_FN("getBrowserOption", give_zero, 1, 0),
    JS_FN("getBrowserProperty", give_false, 1, 0), JS_FN("getRenderingProperty", give_zero, 1, 0),
    JS_FN("isConnected", give_false, 0, 0), JS_FN("isMember", give_false, 0, 0),
    JS_FN("getMenuDisplay", give_zero, 0, 0), JS_FN("getCap", give_zero, 1, 0),
    JS_FN("getCollisionDetection", give_true, 0, 0), JS_FN("getNavigationMode", give_empty, 0, 0),
    JS_FN("getMyName", give_empty, 0, 0), JS_FN("setMyAvatarURL", do_nothing, 1, 0),
    JS_FN("eventNotify", do_nothing, 0, 0), JS_FN("getFloatProperty", give_zero, 1, 0), JS_FS_END};

const JSPropertySpec kBrowserState[] = {JS_PSG("name", get_name, kProperty),
                                        JS_PSG("version", get_version, kProperty),
                                        JS_PSG("currentSpeed", get_speed, kProperty),
                                        JS_PSG("currentFrameRate", get_frame_rate, kProperty),
                                        JS_PSG("worldURL", get_world_url, kProperty),
                                        JS_PSGS("viewpointPosition", viewpoint_position, do_nothing, kProperty),
                                        JS_PSGS("viewpointOrientation", viewpoint_orientation, do_nothing, kProperty),
                                        JS_PS_END};

const JSFunctionSpec kFunctions[] = {JS_FN("print", print, 1, 0),
                                     JS_FN("trace", print, 1, 0),
                                     JS_FN("TRACE", print, 1, 0),
                                     JS_FN("alert", print, 1, 0),
                                     JS_FN("vrmlParseInt", parse_int, 2, 0),
                                     JS_FN("repeatableRandom", random_number, 0, 0),
                                     JS_FN("$copy", copy, 1, 0),
                                     JS_FN("$values", values, 1, 0),
                                     JS_FS_END};

template <Plain kPlain>
bool define_plain(JSContext* context, JS::HandleObject library, const char* name) {
  return JS_DefineFunction(context, library, name, plain<kPlain>, 1, JSFUN_CONSTRUCTOR) != nullptr;
}

}  // namespace

bool define_browser(JSContext* context, JS::HandleObject library) {
  JS::RootedObject browser(context, JS_NewPlainObject(context));
  if (!browser || !JS_DefineFunctions(context, browser, kBrowser) ||
      !JS_DefineProperties(context, browser, kBrowserState) ||
      !JS_DefineProperty(context, library, "Browser", browser, 0) || !JS_DefineFunctions(context, library, kFunctions))
    return false;
  JS::RootedValue yes(context, JS::TrueValue()), no(context, JS::FalseValue()), null(context, JS::NullValue());
  return JS_DefineProperty(context, library, "TRUE", yes, 0) && JS_DefineProperty(context, library, "FALSE", no, 0) &&
         JS_DefineProperty(context, library, "NULL", null, 0) &&
         define_plain<Plain::number>(context, library, "SFFloat") &&
         define_plain<Plain::number>(context, library, "SFTime") &&
         define_plain<Plain::number>(context, library, "SFDouble") &&
         define_plain<Plain::integer>(context, library, "SFInt32") &&
         define_plain<Plain::truth>(context, library, "SFBool") &&
         define_plain<Plain::text>(context, library, "SFString");
}

}  // namespace gs::app::script
