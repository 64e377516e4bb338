#include "app/script/bounds/bounded_natives.h"
#include "app/script/bounds/contained.h"
#include "app/script/natives.h"
#include "app/script/script_world.h"

#include <js/GlobalObject.h>
#include <js/Object.h>
#include <js/Realm.h>
#include <jsfriendapi.h>

#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

// The global object of a Script, with its fields and eventOuts (VRML97 C.5.1). Names that it does not have are looked
// up in the shared library.
namespace gs::app::script {
namespace {

constexpr std::uint32_t kProgramSlot = 0;

// Returns names of standard objects that are omitted. Their memory would not be counted, or they need other threads or
// delayed clean-up. Programs of VRML97 do not use them.
const std::unordered_set<std::string_view>& omitted_names() {
  static const std::unordered_set<std::string_view> names = {
      "ArrayBuffer",   "SharedArrayBuffer",    "DataView",       "Int8Array",
      "Uint8Array",    "Uint8ClampedArray",    "Int16Array",     "Uint16Array",
      "Int32Array",    "Uint32Array",          "Float32Array",   "Float64Array",
      "BigInt64Array", "BigUint64Array",       "WebAssembly",    "Atomics",
      "WeakRef",       "FinalizationRegistry", "ReadableStream", "Intl",
      "BigInt"};
  return names;
}

// ---- Undeclared names, which Contact lets programs read

// Returns the position of the code that runs now; nullopt if it is unknown.
std::optional<Diagnostic> running_place(JSContext* context) {
  JS::AutoFilename file;
  unsigned line = 0, column = 0;
  if (!JS::DescribeScriptedCaller(context, &file, &line, &column) || !file.get()) return std::nullopt;
  return Diagnostic{Severity::warning, file.get(), {line, column + 1}, {}};
}

// Returns undefined for an undeclared name. The first time, warns and makes the name a variable.
bool get_undeclared(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  JS::RootedValue name(context, js::GetFunctionNativeReserved(&args.callee(), 0));
  Program* const program = program_of_global(JS::GetNonCCWObjectGlobal(&args.callee()));
  JS::RootedObject global(context, JS::GetNonCCWObjectGlobal(&args.callee()));
  JS::RootedString string(context, name.toString());
  JS::RootedId id(context);
  std::string text;
  args.rval().setUndefined();
  if (!program || !text_of_value(context, name, text)) return program == nullptr;
  // A test by `typeof` comes before the use.
  if (program->undeclared.is_tested(text)) return true;
  warn(context, "reads '" + text + "', which is not declared; it is undefined", running_place(context));
  return JS_StringToId(context, string, &id) &&
         JS_DefinePropertyById(context, global, id, JS::UndefinedHandleValue, JSPROP_ENUMERATE);
}

// Makes an undeclared name a variable of its value, as ECMAScript does.
bool set_undeclared(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  JS::RootedObject global(context, JS::GetNonCCWObjectGlobal(&args.callee()));
  JS::RootedString name(context, js::GetFunctionNativeReserved(&args.callee(), 0).toString());
  JS::RootedId id(context);
  args.rval().setUndefined();
  return JS_StringToId(context, name, &id) && JS_DefinePropertyById(context, global, id, args.get(0), JSPROP_ENUMERATE);
}

bool define_undeclared(JSContext* context, JS::HandleObject global, JS::HandleId id) {
  JSFunction* const get = js::NewFunctionWithReserved(context, contained<get_undeclared>, 0, 0, nullptr);
  JS::RootedObject getter(context, get ? JS_GetFunctionObject(get) : nullptr);
  JSFunction* const set = js::NewFunctionWithReserved(context, contained<set_undeclared>, 1, 0, nullptr);
  JS::RootedObject setter(context, set ? JS_GetFunctionObject(set) : nullptr);
  if (!getter || !setter) return false;
  js::SetFunctionNativeReserved(getter, 0, JS::StringValue(id.toString()));
  js::SetFunctionNativeReserved(setter, 0, JS::StringValue(id.toString()));
  return JS_DefinePropertyById(context, global, id, getter, setter, 0);
}

bool resolve(JSContext* context, JS::HandleObject global, JS::HandleId id, bool* resolved) {
  *resolved = false;
  bool undeclared = false;
  if (id.isString()) {
    Program* const program = program_of_global(global);
    char name[40];
    JSLinearString* const text = JS_EnsureLinearString(context, id.toString());
    if (!text) return false;
    const std::size_t length = JS::GetLinearStringLength(text);
    if (length < sizeof name) {
      for (std::size_t i = 0; i < length; ++i) {
        const char16_t c = JS::GetLinearStringCharAt(text, i);
        name[i] = c < 128 ? static_cast<char>(c) : '?';
      }
      const std::string_view wanted(name, length);
      if (omitted_names().contains(wanted)) return true;
      undeclared = program && program->world && program->undeclared.contains(wanted);
      if (program && program->world) {
        JS::RootedObject library(context, program->library->global);
        JS::RootedValue value(context);
        bool has = false;
        const char* from = nullptr;
        if (wanted == "parseInt") from = "vrmlParseInt";
        JS::RootedId source(context, id);
        if (from) {
          JS::RootedString other(context, JS_AtomizeString(context, from));
          if (!other || !JS_StringToId(context, other, &source)) return false;
        }
        if (is_library_name(from ? std::string_view(from) : wanted, program->language())) {
          if (!JS_HasOwnPropertyById(context, library, source, &has)) return false;
          if (has) {
            if (!JS_GetPropertyById(context, library, source, &value)) return false;
            *resolved = true;
            return JS_DefinePropertyById(context, global, id, value, 0);
          }
        }
      }
    }
  }
  if (!JS_ResolveStandardClass(context, global, id, resolved)) return false;
  if (*resolved || !undeclared) return true;
  *resolved = true;
  return define_undeclared(context, global, id);
}

const JSClassOps kGlobalOps = {nullptr, nullptr, nullptr, JS_NewEnumerateStandardClasses, contained<resolve>, nullptr,
                               nullptr, nullptr, nullptr, JS_GlobalObjectTraceHook};
const JSClass kGlobalClass = {"global", JSCLASS_GLOBAL_FLAGS, &kGlobalOps, nullptr, nullptr, nullptr};

JS::RealmOptions realm_options() {
  JS::RealmOptions options;
  options.creationOptions()
      .setSharedMemoryAndAtomicsEnabled(false)
      .setWeakRefsEnabled(JS::WeakRefSpecifier::Disabled)
      .setToSourceEnabled(true);  // for toSource() and uneval() of old engines
  return options;
}

// Returns the Script of a getter or setter, and the index `place` of its field or eventOut (C.5.1).
Program* program_of_call(const JS::CallArgs& args, std::uint32_t& place) {
  JSObject* const function = &args.callee();
  place = static_cast<std::uint32_t>(js::GetFunctionNativeReserved(function, 0).toInt32());
  return program_of_global(JS::GetNonCCWObjectGlobal(function));
}

bool get_own(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::uint32_t place = 0;
  Program* const program = program_of_call(args, place);
  if (!program) {
    args.rval().setUndefined();
    return true;
  }
  World& world = *program->world;
  const vrml::InterfaceDeclaration& declaration = program->interface(place);
  if (vrml::is_multiple(declaration.type)) {
    auto& known = program->lists[place];
    if (!known) {
      ListBox box;
      box.program = program;
      box.place = place;
      box.scene = program->scene();
      JSObject* const list = make_list(context, std::move(box), {});
      if (!list) return false;
      known = std::make_unique<JS::PersistentRootedObject>(context, list);
    }
    args.rval().setObject(**known);
    return true;
  }
  if (declaration.type == vrml::FieldType::SFImage && !world.calls().changed().flush(context)) return false;
  const vrml::FieldValue value = program->values[place];
  return to_value(context, program->scene(), value, {program->global, place}, args.rval());
}

bool set_own_native(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::uint32_t place = 0;
  Program* const program = program_of_call(args, place);
  args.rval().setUndefined();
  return !program || set_own(context, *program, place, args.get(0));
}

}  // namespace

ScriptLibrary& library_of(JSContext* context) {
  return *static_cast<ScriptLibrary*>(JS_GetCompartmentPrivate(js::GetContextCompartment(context)));
}

World& world_of(JSContext* context) { return *library_of(context).world; }

void warn(JSContext* context, std::string text, std::optional<Diagnostic> at) {
  world_of(context).view().report(Severity::warning, std::move(text), std::move(at));
}

Program* program_of_global(JSObject* global) {
  if (JS::GetClass(global) != &kGlobalClass) return nullptr;
  return JS::GetMaybePtrFromReservedSlot<Program>(global, kProgramSlot);
}

JSObject* new_global(JSContext* context, Program* program, JS::HandleObject beside) {
  JS::RealmOptions options = realm_options();
  if (beside)
    options.creationOptions().setExistingCompartment(beside);
  else
    options.creationOptions().setNewCompartmentAndZone();
  JSObject* const global = JS_NewGlobalObject(context, &kGlobalClass, nullptr, JS::FireOnNewGlobalHook, options);
  if (global) JS::SetReservedSlot(global, kProgramSlot, JS::PrivateValue(program));
  return global;
}

void forget_program(JSObject* global) { JS::SetReservedSlot(global, kProgramSlot, JS::PrivateValue(nullptr)); }

bool is_library_name(std::string_view name, vrml::Language language) {
  static const std::unordered_set<std::string_view> x3d_names = {"SFColorRGBA",
                                                                 "SFVec2d",
                                                                 "SFVec3d",
                                                                 "SFVec4f",
                                                                 "SFVec4d",
                                                                 "SFMatrix3f",
                                                                 "SFMatrix3d",
                                                                 "SFMatrix4f",
                                                                 "SFMatrix4d",
                                                                 "MFBool",
                                                                 "MFColorRGBA",
                                                                 "MFDouble",
                                                                 "MFImage",
                                                                 "MFVec2d",
                                                                 "MFVec3d",
                                                                 "MFVec4f",
                                                                 "MFVec4d",
                                                                 "MFMatrix3f",
                                                                 "MFMatrix3d",
                                                                 "MFMatrix4f",
                                                                 "MFMatrix4d",
                                                                 "X3DMatrix3",
                                                                 "X3DMatrix4",
                                                                 "X3DConstants",
                                                                 "X3DExecutionContext",
                                                                 "X3DScene",
                                                                 "X3DRoute",
                                                                 "RouteArray",
                                                                 "X3DFieldDefinition",
                                                                 "FieldDefinitionArray",
                                                                 "X3DProtoDeclaration",
                                                                 "ProtoDeclarationArray",
                                                                 "X3DExternProtoDeclaration",
                                                                 "ExternProtoDeclarationArray",
                                                                 "ProfileInfo",
                                                                 "ProfileInfoArray",
                                                                 "ComponentInfo",
                                                                 "ComponentInfoArray",
                                                                 "console"};
  if (language == vrml::Language::x3d && x3d_names.contains(name)) return true;
  static const std::unordered_set<std::string_view> names = {
      "SFColor", "SFRotation", "SFVec2f",  "SFVec3f",      "SFImage", "SFNode",  "MFColor", "MFFloat", "MFInt32",
      "MFNode",  "MFRotation", "MFString", "MFTime",       "MFVec2f", "MFVec3f", "SFFloat", "SFTime",  "SFDouble",
      "SFInt32", "SFBool",     "SFString", "VrmlMatrix",   "Browser", "print",   "trace",   "TRACE",   "alert",
      "TRUE",    "FALSE",      "NULL",     "vrmlParseInt", "$copy",   "$values", "$browser"};
  return names.contains(name);
}

bool make_global(JSContext* context, Program& program, bool repeatable) {
  JS::RootedObject global(context, new_global(context, &program, program.library->global));
  if (!global) return false;
  program.global.init(context, global);
  const JSAutoRealm realm(context, global);
  if (!bound_natives(context, global)) return false;
  const vrml::NodeType& script_type = *program.facts->type;
  const auto& interfaces = script_type.interfaces;
  program.names.resize(interfaces.size());
  program.lists.resize(interfaces.size());
  program.unsent.resize(interfaces.size());
  program.counted.resize(interfaces.size());
  for (std::uint32_t place = 0; place < interfaces.size(); ++place) {
    const vrml::InterfaceDeclaration& declaration = interfaces[place];
    JS::RootedString name(context, JS_AtomizeAndPinString(context, declaration.name.c_str()));
    JS::RootedId id(context);
    if (!name || !JS_StringToId(context, name, &id)) return false;
    program.names[place] = id;
    if (declaration.access == vrml::AccessType::eventIn) continue;
    if (is_own_field_of_script(program.language(), declaration)) continue;
    JSFunction* const get = js::NewFunctionWithReserved(context, contained<get_own>, 0, 0, nullptr);
    JS::RootedObject getter(context, get ? JS_GetFunctionObject(get) : nullptr);
    JSFunction* const set = js::NewFunctionWithReserved(context, contained<set_own_native>, 1, 0, nullptr);
    JS::RootedObject setter(context, set ? JS_GetFunctionObject(set) : nullptr);
    if (!getter || !setter) return false;
    js::SetFunctionNativeReserved(getter, 0, JS::Int32Value(static_cast<std::int32_t>(place)));
    js::SetFunctionNativeReserved(setter, 0, JS::Int32Value(static_cast<std::int32_t>(place)));
    const unsigned attributes = JSPROP_ENUMERATE | JSPROP_PERMANENT;
    if (!JS_DefinePropertyById(context, global, id, getter, setter, attributes)) return false;
    // X3D programs also know the field x of type inputOutput as x_changed.
    const std::string changed = declaration.name + "_changed";
    if (program.language() == vrml::Language::x3d && declaration.access == vrml::AccessType::exposedField &&
        !script_type.find(changed) &&
        !JS_DefineProperty(context, global, changed.c_str(), getter, setter, JSPROP_PERMANENT))
      return false;
  }
  if (repeatable) {
    JS::RootedValue math(context), random(context);
    if (!JS_GetProperty(context, program.library->global, "repeatableRandom", &random) ||
        !JS_GetProperty(context, global, "Math", &math) || !math.isObject())
      return false;
    JS::RootedObject object(context, &math.toObject());
    if (!JS_SetProperty(context, object, "random", random)) return false;
  }
  return true;
}

}  // namespace gs::app::script
