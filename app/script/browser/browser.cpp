#include "app/script/bounds/contained.h"
#include "app/script/browser/browser_natives.h"
#include "app/script/script_world.h"

#include <js/Array.h>
#include <js/Conversions.h>
#include <js/Object.h>
#include <js/PropertySpec.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

// The Browser object (VRML97 4.12.10, C.6.3), print() and trace(), constants, and further functions that browsers of
// the VRML97 era offered.
namespace gs::app::script {
namespace {

constexpr std::size_t kMaxTold = 4096;  // max characters of a printed line and of a description

bool texts_argument(JSContext* context, const JS::CallArgs& args, unsigned index, vrml::FieldValue& texts) {
  texts = vrml::MFString{};
  return index >= args.length() || args[index].isNullOrUndefined() ||
         to_field(context, args[index], vrml::FieldType::MFString, 0, texts);
}

bool get_name(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, "GhostSpace", JS::CallArgsFromVp(argc, vp).rval());
}
bool get_version(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, GHOSTSPACE_VERSION, JS::CallArgsFromVp(argc, vp).rval());
}
bool get_speed(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(world_of(context).view().browser().speed));
  return true;
}
bool get_frame_rate(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(world_of(context).view().browser().frame_rate));
  return true;
}
bool get_world_url(JSContext* context, unsigned argc, JS::Value* vp) {
  return make_string(context, world_of(context).view().browser().world_url, JS::CallArgsFromVp(argc, vp).rval());
}
bool get_time(JSContext* context, unsigned argc, JS::Value* vp) {
  JS::CallArgsFromVp(argc, vp).rval().set(JS::NumberValue(world_of(context).calls().clock().now()));
  return true;
}

bool replace_world(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  Question question{Ask::replace_world};
  args.rval().setUndefined();
  if (!to_field(context, args.get(0), vrml::FieldType::MFNode, world.calls().running().scene(), question.value))
    return false;
  if (!world.view().ask(question).good) return fail(context, "replaceWorld expects nodes of the world's own file");
  return true;
}

bool create_from_string(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::string text;
  ListBox box;
  vrml::MFNode nodes;
  if (!text_of_value(context, args.get(0), text)) return false;
  if (!nodes_from_text(context, std::move(text), nodes, box.scene)) return false;
  box.value = std::move(nodes);
  JSObject* const list = make_list(context, std::move(box), {});
  args.rval().setObjectOrNull(list);
  return list != nullptr;
}

bool create_from_url(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Question question{Ask::create_from_url};
  args.rval().setUndefined();
  if (!texts_argument(context, args, 0, question.value) || !text_of_value(context, args.get(2), question.text))
    return false;
  question.node = node_of_value(args.get(1));
  if (!question.node) return fail(context, "createVrmlFromURL expects a node that receives the nodes");
  if (!world_of(context).view().ask(question).good)
    return fail(context, "the node has no MFNode eventIn '" + question.text.substr(0, 80) + "'");
  return true;
}

bool load_url(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Question question{Ask::load_url};
  args.rval().setUndefined();
  if (!texts_argument(context, args, 0, question.value) || !texts_argument(context, args, 1, question.second))
    return false;
  (void)world_of(context).view().ask(question);
  return true;
}

template <Ask kAsk>
bool tell_text(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Question question{kAsk};
  args.rval().setUndefined();
  if (!cut_text_of_value(context, args.get(0), kMaxTold, question.text)) return false;
  (void)world_of(context).view().ask(question);
  return true;
}

bool print(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::string line, text;
  for (unsigned i = 0; i < args.length() && line.size() < kMaxTold; ++i) {
    if (!cut_text_of_value(context, args[i], kMaxTold, text)) return false;
    line += (i ? " " : "") + text;
  }
  world_of(context).view().print(std::move(line));
  args.rval().setUndefined();
  return true;
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
  } else if (JS::RootedObject rooted(context, object); JSObject* const matrix = copy_of_matrix(context, rooted)) {
    made = matrix;
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

// Table of the methods of the Browser object. docs/manual.md lists them.
const JSFunctionSpec kBrowser[] = {
    // Functions of Table C.1
    JS_FN("getName", contained<get_name>, 0, 0), JS_FN("getVersion", contained<get_version>, 0, 0),
    JS_FN("getCurrentSpeed", contained<get_speed>, 0, 0), JS_FN("getCurrentFrameRate", contained<get_frame_rate>, 0, 0),
    JS_FN("getWorldURL", contained<get_world_url>, 0, 0), JS_FN("replaceWorld", contained<replace_world>, 1, 0),
    JS_FN("createVrmlFromString", contained<create_from_string>, 1, 0),
    JS_FN("createVrmlFromURL", contained<create_from_url>, 3, 0), JS_FN("addRoute", contained<add_route>, 4, 0),
    JS_FN("deleteRoute", contained<delete_route>, 4, 0), JS_FN("loadURL", contained<load_url>, 2, 0),
    JS_FN("setDescription", contained<tell_text<Ask::describe_world>>, 1, 0),
    // Other spellings of these functions, which worlds and even the examples of Annex C use
    JS_FN("createVRMLFromString", contained<create_from_string>, 1, 0),
    JS_FN("createVRMLFromURL", contained<create_from_url>, 3, 0),
    JS_FN("createVrmlFromUrl", contained<create_from_url>, 3, 0),
    JS_FN("createX3DFromString", contained<create_from_string>, 1, 0),
    JS_FN("createX3DFromURL", contained<create_from_url>, 3, 0), JS_FN("loadUrl", contained<load_url>, 2, 0),
    JS_FN("loadURLrel", contained<load_url>, 2, 0), JS_FN("getWorldUrl", contained<get_world_url>, 0, 0),
    JS_FN("print", contained<print>, 1, 0), JS_FN("println", contained<print>, 1, 0),
    // Functions of Cosmo Player, Blaxxun Contact and Cortona. Time, files and settings
    JS_FN("getTime", contained<get_time>, 0, 0), JS_FN("getCurrentTime", contained<get_time>, 0, 0),
    JS_FN("getWorldStartTime", contained<get_start_time>, 0, 0),
    JS_FN("getWorldBaseURL", contained<get_world_base_url>, 0, 0), JS_FN("getBaseURL", contained<get_base_url>, 0, 0),
    JS_FN("getOption", contained<get_option>, 1, 0), JS_FN("setOption", contained<set_option>, 2, 0),
    JS_FN("getScript", contained<get_script>, 0, 0), JS_FN("getImportedNode", contained<get_imported_node>, 1, 0),
    JS_FN("isKeyPressed", contained<is_key_pressed>, 1, 0),
    // Viewer and window
    JS_FN("setViewpoint", contained<tell_text<Ask::set_viewpoint>>, 1, 0),
    JS_FN("setViewpointByValue", contained<set_viewpoint_by_value>, 3, 0),
    JS_FN("getViewpointByValue", contained<get_viewpoint_by_value>, 3, 0),
    JS_FN("computeRayHit", contained<compute_ray_hit>, 3, 0),
    JS_FN("getWindowSizeX", contained<get_window_width>, 0, 0),
    JS_FN("getWindowSizeY", contained<get_window_height>, 0, 0),
    JS_FN("getWindowAspect", contained<get_window_aspect>, 0, 0),
    // Navigation
    JS_FN("getNavigationMode", contained<get_navigation_mode>, 0, 0),
    JS_FN("setNavigationMode", contained<set_navigation_mode>, 1, 0),
    JS_FN("getAvatarHeight", contained<get_measure<Measure::height>>, 0, 0),
    JS_FN("setAvatarHeight", contained<set_measure<Measure::height>>, 1, 0),
    JS_FN("getStepOverSize", contained<get_measure<Measure::step>>, 0, 0),
    JS_FN("setStepOverSize", contained<set_measure<Measure::step>>, 1, 0),
    JS_FN("getCollisionDistance", contained<get_measure<Measure::distance>>, 0, 0),
    JS_FN("setCollisionDistance", contained<set_measure<Measure::distance>>, 1, 0),
    JS_FN("getVisibilityLimit", contained<get_measure<Measure::visibility>>, 0, 0),
    JS_FN("setVisibilityLimit", contained<set_measure<Measure::visibility>>, 1, 0),
    JS_FN("getWalkSpeed", contained<get_measure<Measure::speed>>, 0, 0),
    JS_FN("setWalkSpeed", contained<set_measure<Measure::speed>>, 1, 0), JS_FN("getZNear", contained<get_z_near>, 0, 0),
    JS_FN("getZFar", contained<get_z_far>, 0, 0), JS_FN("getHeadlight", contained<get_headlight>, 0, 0),
    JS_FN("getHeadLight", contained<get_headlight>, 0, 0), JS_FN("setHeadlight", contained<set_headlight>, 1, 0),
    JS_FN("setHeadLight", contained<set_headlight>, 1, 0), JS_FN("getGravity", contained<get_setting<kGravity>>, 0, 0),
    JS_FN("setGravity", contained<set_setting<kGravity>>, 1, 0),
    JS_FN("getCollisionDetection", contained<get_setting<kCollision>>, 0, 0),
    JS_FN("setCollisionDetection", contained<set_setting<kCollision>>, 1, 0),
    JS_FN("getSoundEnabled", contained<get_setting<kSound>>, 0, 0),
    JS_FN("setSoundEnabled", contained<set_setting<kSound>>, 1, 0),
    JS_FN("getViewpointAnimation", contained<get_setting<kViewpointAnimation>>, 0, 0),
    JS_FN("setViewpointAnimation", contained<set_setting<kViewpointAnimation>>, 1, 0),
    // Functions without effect: consoles, avatars, loading and rendering of other browsers
    JS_FN("showConsole", contained<do_nothing>, 0, 0), JS_FN("hideConsole", contained<do_nothing>, 0, 0),
    JS_FN("beginUpdate", contained<do_nothing>, 0, 0), JS_FN("endUpdate", contained<do_nothing>, 0, 0),
    JS_FN("setFocus", contained<do_nothing>, 0, 0), JS_FN("setCpuLoad", contained<do_nothing>, 1, 0),
    JS_FN("setLocalLightRadius", contained<do_nothing>, 1, 0), JS_FN("setBspMode", contained<do_nothing>, 1, 0),
    JS_FN("setBspLoadingMode", contained<do_nothing>, 1, 0), JS_FN("setUnloadDist", contained<do_nothing>, 1, 0),
    JS_FN("setLoadDist", contained<do_nothing>, 1, 0), JS_FN("setUnloadMode", contained<do_nothing>, 2, 0),
    JS_FN("setPrefetch", contained<do_nothing>, 1, 0), JS_FN("prefetch", contained<give_zero>, 3, 0),
    JS_FN("setRenderMode", contained<do_nothing>, 1, 0), JS_FN("setBrowserOption", contained<do_nothing>, 2, 0),
    JS_FN("getBrowserOption", contained<give_zero>, 1, 0), JS_FN("getBrowserProperty", contained<give_false>, 1, 0),
    JS_FN("getRenderingProperty", contained<give_zero>, 1, 0), JS_FN("isConnected", contained<give_false>, 0, 0),
    JS_FN("isMember", contained<give_false>, 0, 0), JS_FN("getMenuDisplay", contained<give_zero>, 0, 0),
    JS_FN("getCap", contained<give_zero>, 1, 0), JS_FN("getMyName", contained<give_empty>, 0, 0),
    JS_FN("getInstallDirectory", contained<give_empty>, 0, 0), JS_FN("setMyAvatar", contained<do_nothing>, 1, 0),
    JS_FN("setMyAvatarURL", contained<do_nothing>, 1, 0), JS_FN("setMyAvatarName", contained<do_nothing>, 1, 0),
    JS_FN("showMyAvatar", contained<give_false>, 1, 0), JS_FN("getThirdPersonView", contained<give_false>, 0, 0),
    JS_FN("setThirdPersonView", contained<give_false>, 1, 0), JS_FN("mouseSelect", contained<do_nothing>, 1, 0),
    JS_FN("computeCollision", contained<do_nothing>, 5, 0), JS_FN("eventNotify", contained<do_nothing>, 0, 0),
    JS_FN("getFloatProperty", contained<give_zero>, 1, 0), JS_FS_END};

const JSPropertySpec kBrowserState[] = {
    JS_PSG("name", contained<get_name>, kProperty),
    JS_PSG("version", contained<get_version>, kProperty),
    JS_PSG("currentSpeed", contained<get_speed>, kProperty),
    JS_PSG("currentFrameRate", contained<get_frame_rate>, kProperty),
    JS_PSG("worldURL", contained<get_world_url>, kProperty),
    JS_PSGS("viewpointPosition", contained<get_viewpoint_position>, contained<set_viewpoint_position>, kProperty),
    JS_PSGS("viewpointOrientation", contained<get_viewpoint_orientation>, contained<set_viewpoint_orientation>,
            kProperty),
    JS_PSGS("boundViewpoint", contained<get_bound_viewpoint>, contained<do_nothing>, kProperty),
    JS_PSGS("windowSize", contained<get_window_size>, contained<do_nothing>, kProperty),
    JS_PSGS("windowAspect", contained<get_window_aspect>, contained<do_nothing>, kProperty),
    JS_PSGS("eventMask", contained<get_event_mask>, contained<set_event_mask>, kProperty),
    JS_PSGS("myAvatarURL", contained<give_empty>, contained<do_nothing>, kProperty),
    JS_PSGS("myAvatarName", contained<give_empty>, contained<do_nothing>, kProperty),
    JS_PS_END};

// Implements $browser(name), which returns an object with a method of this name; see contact_text(). That is the
// Browser object, if a program has given it such a method. Otherwise warns once, and the method does nothing.
bool browser_with(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  JS::RootedObject library(context, library_of(context).global);
  JS::RootedValue browser(context), method(context);
  std::string name;
  if (!cut_text_of_value(context, args.get(0), kMaxTold, name)) return false;
  if (!JS_GetProperty(context, library, "Browser", &browser) || !browser.isObject()) return false;
  JS::RootedObject object(context, &browser.toObject());
  if (!JS_GetProperty(context, object, name.c_str(), &method)) return false;
  args.rval().set(browser);
  if (method.isObject() && JS::IsCallable(&method.toObject())) return true;
  warn(context, "Browser has no method '" + name.substr(0, 80) + "'; it does nothing");
  JS::RootedObject stand_in(context, JS_NewPlainObject(context));
  args.rval().setObjectOrNull(stand_in);
  return stand_in && JS_DefineFunction(context, stand_in, name.c_str(), do_nothing, 0, 0) != nullptr;
}

const JSFunctionSpec kFunctions[] = {JS_FN("print", contained<print>, 1, 0),
                                     JS_FN("trace", contained<print>, 1, 0),
                                     JS_FN("TRACE", contained<print>, 1, 0),
                                     JS_FN("alert", contained<print>, 1, 0),
                                     JS_FN("vrmlParseInt", contained<parse_int>, 2, 0),
                                     JS_FN("repeatableRandom", contained<random_number>, 0, 0),
                                     JS_FN("$copy", contained<copy>, 1, 0),
                                     JS_FN("$values", contained<values>, 1, 0),
                                     JS_FN("$browser", contained<browser_with>, 1, 0),
                                     JS_FS_END};

template <Plain kPlain>
bool define_plain(JSContext* context, JS::HandleObject library, const char* name) {
  return JS_DefineFunction(context, library, name, plain<kPlain>, 1, JSFUN_CONSTRUCTOR) != nullptr;
}

}  // namespace

bool is_browser_method(std::string_view name) {
  return std::any_of(std::begin(kBrowser), std::end(kBrowser),
                     [&](const JSFunctionSpec& one) { return one.name.string() && one.name.string() == name; });
}

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
