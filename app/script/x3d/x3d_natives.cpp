#include "app/script/x3d/x3d_natives.h"
#include "app/script/bounds/contained.h"

#include "app/script/script_world.h"
#include "vrml/scene/prototype.h"
#include "vrml/scene/x3d/x3d_components.h"

#include <js/Array.h>
#include <js/Object.h>
#include <js/PropertySpec.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

// Access to the nodes, PROTOs and ROUTEs of the text of the running program (ISO/IEC 19775-2 6.4). The first argument
// of most functions selects a text by one of its nodes. Null selects the program's own text. A program inside a PROTO
// instance sees only the nodes of that instance.
namespace gs::app::script {
namespace {

/// Text in which nodes are looked up, and the PROTO instance inside it; 0 means outside of instances.
struct Context {
  vrml::SceneGraph* scene = nullptr;
  const vrml::SourceText* text = nullptr;
  std::uint32_t owner = 0;     // index of the text; 0 is the file
  std::uint32_t instance = 0;  // index of the instance's node
  [[nodiscard]] bool has(const vrml::Node& node) const {
    return node.text == text && node.instance == instance && !node.in_prototype_body;
  }
};

Context context_of(JSContext* context, JS::HandleValue of) {
  const Program& program = world_of(context).calls().running();
  Context found{program.scene, nullptr, 0, 0};
  const vrml::Node* node = &program.scene->node(program.id);
  const NodeBox* const box = of.isObject() ? node_of(&of.toObject()) : nullptr;
  if (box && box->live_scene()) {
    found.scene = box->live_scene();
    node = &found.scene->node(box->id);
  }
  found.text = node->text;
  found.owner = node->owner;
  found.instance = node->instance;
  return found;
}

const vrml::Node* node_argument(JSContext* context, JS::HandleValue value) {
  const NodeBox* const box = value.isObject() ? node_of(&value.toObject()) : nullptr;
  vrml::SceneGraph* const scene = box ? box->live_scene() : nullptr;
  const vrml::Node* const node = scene ? &scene->node(box->id) : nullptr;
  return node && may_read(context, *node) ? node : nullptr;
}

/// Array of texts, numbers and objects that a function returns.
class Result {
 public:
  explicit Result(JSContext* context) : context_(context), values_(context) {}
  bool text(std::string_view text) {
    JS::RootedValue value(context_);
    return make_string(context_, text, &value) && values_.append(value);
  }
  bool number(double number) { return values_.append(JS::NumberValue(number)); }
  bool object(JSObject* object) { return object && values_.append(JS::ObjectValue(*object)); }
  bool give(const JS::CallArgs& args) {
    JSObject* const array = JS::NewArrayObject(context_, JS::HandleValueArray(values_));
    args.rval().setObjectOrNull(array);
    return array != nullptr;
  }

 private:
  JSContext* context_;
  JS::RootedValueVector values_;
};

bool add_fields(Result& result, const vrml::NodeType& type) {
  for (const vrml::InterfaceDeclaration& one : type.interfaces) {
    if (one.of_other_browsers) continue;
    if (!result.text(vrml::name_in(vrml::Language::x3d, one)) || !result.number(static_cast<double>(one.access)) ||
        !result.number(static_cast<double>(one.type)))
      return false;
  }
  return true;
}

// Returns the name, access type and type of each field of a node, one after the other.
bool fields(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Result result(context);
  const vrml::Node* const node = node_argument(context, args.get(0));
  return (!node || add_fields(result, *node->type)) && result.give(args);
}

// Returns the names of the types of a node: its own, and the abstract types that it derives from.
bool types(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const vrml::Node* const node = node_argument(context, args.get(0));
  return make_string(context, node ? node->type->bases + " " + node->type->name : std::string(), args.rval());
}

// Returns the names of all node types and abstract types of X3D.
bool type_names(JSContext* context, unsigned argc, JS::Value* vp) {
  std::string names;
  for (const auto& type : vrml::built_in_node_types(vrml::Language::x3d)) names += type->bases + " " + type->name + " ";
  return make_string(context, names, JS::CallArgsFromVp(argc, vp).rval());
}

// Returns the name and the highest supported level of each component, one after the other.
bool components(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::map<std::string, int> levels;
  for (const auto& type : vrml::built_in_node_types(vrml::Language::x3d))
    if (const vrml::X3DComponent* const known = vrml::x3d_component_named(type->component);
        known && known->supported > 0)
      levels[type->component] = known->supported;
  Result result(context);
  for (const auto& [name, level] : levels)
    if (!result.text(name) || !result.number(level)) return false;
  return result.give(args);
}

// Returns the node with a DEF name; null if there is none.
bool named(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const Context in = context_of(context, args.get(0));
  std::string name;
  args.rval().setNull();
  if (!text_of_value(context, args.get(1), name) || name.empty()) return !JS_IsExceptionPending(context);
  for (std::uint32_t i = 1; i <= in.scene->nodes().count(); ++i) {
    const vrml::Node& node = in.scene->nodes().at(i);
    const vrml::NodeId id = in.scene->nodes().id_at(i);
    if (!in.scene->contains(id) || node.name != name || !in.has(node) || !may_read(context, node)) continue;
    JSObject* const object = object_of_node(context, *in.scene, id);
    args.rval().setObjectOrNull(object);
    return object != nullptr;
  }
  return true;
}

// Returns the top-level nodes of the text, or of the body of the PROTO instance.
bool roots(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const Context in = context_of(context, args.get(0));
  vrml::MFNode nodes;
  if (in.instance != 0)
    nodes = in.scene->nodes().at(in.instance).expansion;
  else
    nodes = in.text->roots();
  ListBox box;
  box.scene = in.scene;
  vrml::MFNode readable;
  for (const vrml::NodeId id : nodes)
    if (in.scene->contains(id) && may_read(context, in.scene->node(id))) readable.push_back(id);
  box.value = std::move(readable);
  JSObject* const list = make_list(context, std::move(box), {});
  args.rval().setObjectOrNull(list);
  return list != nullptr;
}

// Replaces the top-level nodes of the file. Returns false if the program is not part of a file.
bool set_roots(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  const Context in = context_of(context, JS::NullHandleValue);
  vrml::FieldValue nodes;
  args.rval().setBoolean(false);
  if (in.owner != 0 || in.instance != 0 || !world.calls().may_act()) return true;
  if (!to_field(context, args.get(0), vrml::FieldType::MFNode, in.scene, nodes)) return false;
  args.rval().setBoolean(world.execution().lifetime().set_roots(*in.scene, std::get<vrml::MFNode>(nodes)));
  return true;
}

// Returns source, eventOut, target and eventIn of each ROUTE of the text, one after the other.
bool routes(JSContext* context, unsigned argc, JS::Value* vp) {
  constexpr std::size_t kMax = 100'000;
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const Context in = context_of(context, args.get(0));
  Result result(context);
  std::size_t count = 0;
  for (const vrml::PlacedRoute& one : world_of(context).execution().routes().all()) {
    const vrml::Route& route = one.route;
    if (one.scene != in.scene || !in.scene->contains(route.from) || !in.scene->contains(route.to)) continue;
    const vrml::Node &from = in.scene->node(route.from), &to = in.scene->node(route.to);
    if (!in.has(from) || !in.has(to) || !may_read(context, from) || !may_read(context, to)) continue;
    if (++count > kMax) break;
    JS::RootedObject source(context, object_of_node(context, *in.scene, route.from));
    JS::RootedObject target(context, object_of_node(context, *in.scene, route.to));
    if (!result.object(source) || !result.text(vrml::name_in(vrml::Language::x3d, *route.event_out)) ||
        !result.object(target) || !result.text(vrml::name_in(vrml::Language::x3d, *route.event_in)))
      return false;
  }
  return result.give(args);
}

// Returns the name of each PROTO or EXTERNPROTO of the text.
bool prototypes(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const Context in = context_of(context, args.get(0));
  const auto kind = args.get(1).isTrue() ? vrml::NodeType::Kind::external_prototype : vrml::NodeType::Kind::prototype;
  Result result(context);
  for (const auto& type : in.text->types())
    if (type->kind == kind && !result.text(type->name)) return false;
  return result.give(args);
}

const vrml::NodeType* prototype_named(const Context& in, std::string_view name) {
  for (const auto& type : in.text->types())
    if (type->name == name &&
        (type->kind == vrml::NodeType::Kind::prototype || type->kind == vrml::NodeType::Kind::external_prototype))
      return type.get();
  return nullptr;
}

bool prototype_fields(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::string name;
  if (!text_of_value(context, args.get(1), name)) return false;
  const vrml::NodeType* const type = prototype_named(context_of(context, args.get(0)), name);
  Result result(context);
  return (!type || add_fields(result, *type)) && result.give(args);
}

bool prototype_urls(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  std::string name;
  if (!text_of_value(context, args.get(1), name)) return false;
  const vrml::NodeType* const type = prototype_named(context_of(context, args.get(0)), name);
  ListBox box;
  box.value = type ? type->url : vrml::MFString{};
  JSObject* const list = make_list(context, std::move(box), {});
  args.rval().setObjectOrNull(list);
  return list != nullptr;
}

// Makes an instance of a PROTO of the text. Returns null if there is no such PROTO.
bool create_instance(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  std::string name;
  if (!text_of_value(context, args.get(1), name)) return false;
  const Context in = context_of(context, args.get(0));
  const vrml::NodeType* const type = prototype_named(in, name);
  args.rval().setNull();
  if (!type) return true;
  if (!world.calls().may_act()) return fail(context, "shutdown() cannot create nodes");
  vrml::NodeId made;
  {
    // The instance keeps the text that owns its type. A node of the file itself would never be removed.
    std::optional<vrml::RunTimeText> written;
    std::optional<vrml::WritingFor> writing;
    if (in.owner == 0)
      written.emplace(*in.scene, label_of(world.calls().running()), *in.text);
    else
      writing.emplace(*in.scene, in.owner);
    made = in.scene->create(*type, world.calls().running().scene->node(world.calls().running().id).location);
    if (!made) return fail(context, "not enough memory for a node");
    (void)vrml::instantiate(*in.scene, made);
  }
  world.execution().scenes().attach(*in.scene);
  world.engine().note_nodes(std::max<std::size_t>(64, type->prototype ? type->prototype->nodes.size() : 0));
  JSObject* const object = object_of_node(context, *in.scene, made);
  args.rval().setObjectOrNull(object);
  return object != nullptr;
}

// Returns a key of the text, its URL, ten times its version, and whether it is a PROTO instance.
bool context_facts(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const Context in = context_of(context, args.get(0));
  const auto& source = in.text->source();
  const std::string key =
      std::to_string(in.scene->serial()) + ' ' + std::to_string(in.owner) + ' ' + std::to_string(in.instance);
  Result result(context);
  return result.text(key) && result.text(source ? source->url : world_of(context).browser().world_url) &&
         result.number(in.text->version()) && result.number(in.instance != 0 ? 1 : 0) &&
         result.text(in.text->x3d().profile) && result.give(args);
}

// Returns the name and the level of each COMPONENT statement, one after the other.
bool stated_components(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Result result(context);
  for (const vrml::X3DStatements::Component& one : context_of(context, args.get(0)).text->x3d().components)
    if (!result.text(one.name) || !result.number(one.level)) return false;
  return result.give(args);
}

// Returns the name and the content of each META statement, one after the other.
bool metas(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Result result(context);
  for (const vrml::X3DStatements::Meta& one : context_of(context, args.get(0)).text->x3d().metas)
    if (!result.text(one.name) || !result.text(one.content)) return false;
  return result.give(args);
}

// Returns the node that the text exports under a name; null if there is none.
bool exported(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const Context in = context_of(context, args.get(0));
  std::string name;
  args.rval().setNull();
  if (!text_of_value(context, args.get(1), name)) return false;
  for (const vrml::X3DStatements::Export& one : in.text->x3d().exports) {
    if (one.exported != name || !in.scene->contains(one.node) || !may_read(context, in.scene->node(one.node))) continue;
    JSObject* const object = object_of_node(context, *in.scene, one.node);
    args.rval().setObjectOrNull(object);
    return object != nullptr;
  }
  return true;
}

const JSFunctionSpec kNatives[] = {JS_FN("$x3d_fields", contained<fields>, 1, 0),
                                   JS_FN("$x3d_types", contained<types>, 1, 0),
                                   JS_FN("$x3d_typeNames", contained<type_names>, 0, 0),
                                   JS_FN("$x3d_components", contained<components>, 0, 0),
                                   JS_FN("$x3d_named", contained<named>, 2, 0),
                                   JS_FN("$x3d_roots", contained<roots>, 1, 0),
                                   JS_FN("$x3d_setRoots", contained<set_roots>, 1, 0),
                                   JS_FN("$x3d_routes", contained<routes>, 1, 0),
                                   JS_FN("$x3d_protos", contained<prototypes>, 2, 0),
                                   JS_FN("$x3d_protoFields", contained<prototype_fields>, 2, 0),
                                   JS_FN("$x3d_protoUrls", contained<prototype_urls>, 2, 0),
                                   JS_FN("$x3d_createProto", contained<create_instance>, 2, 0),
                                   JS_FN("$x3d_statedComponents", contained<stated_components>, 1, 0),
                                   JS_FN("$x3d_metas", contained<metas>, 1, 0),
                                   JS_FN("$x3d_exported", contained<exported>, 2, 0),
                                   JS_FN("$x3d_context", contained<context_facts>, 1, 0),
                                   JS_FS_END};

}  // namespace

bool define_x3d_natives(JSContext* context, JS::HandleObject library) {
  return JS_DefineFunctions(context, library, kNatives);
}

}  // namespace gs::app::script
