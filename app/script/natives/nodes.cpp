#include "app/script/bounds/bounded_natives.h"
#include "app/script/bounds/contained.h"
#include "app/script/natives.h"
#include "app/script/natives/live_proxy.h"
#include "app/script/script_world.h"

#include <js/Conversions.h>
#include <js/Object.h>
#include <js/PropertySpec.h>
#include <js/Proxy.h>
#include <jsfriendapi.h>

#include <optional>
#include <utility>

// SFNode (VRML97 C.6.6). The eventIns, eventOuts and exposedFields of a node are properties (C.5.2). Each library has
// at most one object for a node, so that comparing objects compares nodes. The object holds the node as long as it
// exists.
namespace gs::app::script {
namespace {

using vrml::AccessType;
using vrml::InterfaceDeclaration;

// Returns the name of a property in `name`; empty for a symbol or index.
bool name_of_id(JSContext* context, JS::HandleId id, std::string& name) {
  name.clear();
  if (!id.isString()) return true;
  JS::RootedValue value(context, JS::StringValue(id.toString()));
  return text_of_value(context, value, name);
}

// Returns the type of a node. Returns null if the node is no longer part of the world.
const vrml::NodeType* type_in_world(JSContext* context, NodeBox& box) {
  if (!box.lives()) return nullptr;
  if (box.type) return box.type.get();
  World& world = world_of(context);
  const Answer answer = world.view().ask({Ask::describe, box.node});
  if (!answer.good) return nullptr;
  box.type = answer.type;
  if (answer.flag) box.readable_by = world.calls().running().serial;
  return box.type.get();
}

// Returns the type of a node. Returns null if the node is no longer part of the world, or if the running program may
// not read it.
const vrml::NodeType* readable_type(JSContext* context, NodeBox& box) {
  const vrml::NodeType* const type = type_in_world(context, box);
  return type && may_read(context, box) ? type : nullptr;
}

std::uint32_t place_of(const vrml::NodeType& type, const InterfaceDeclaration& declaration) {
  std::uint32_t place = 0;
  for (const InterfaceDeclaration& one : type.interfaces) {
    if (&one == &declaration) break;
    ++place;
  }
  return place;
}

// Returns the value of an interface. The running program has newer values of its own Script than the world.
std::optional<vrml::FieldValue> value_of(World& world, const NodeBox& box, std::uint32_t place) {
  const Program& program = world.calls().running();
  if (box.node != program.facts->node) return world.view().read(box.node, place);
  if (program.interface(place).access == AccessType::eventIn) return std::nullopt;
  return program.values[place];
}

// Returns the eventIn of a name. Like browsers of the VRML97 era, also finds an eventIn without its prefix: `bind`
// means `set_bind`.
const InterfaceDeclaration* event_in(const vrml::NodeType& type, const std::string& name) {
  if (const InterfaceDeclaration* found = type.find_event_in(name)) return found;
  const InterfaceDeclaration* found = type.find("set_" + name);
  return found && found->access == AccessType::eventIn ? found : nullptr;
}

// Returns the field, exposedField or eventOut of a name. Fields are not accessible by the standard (C.5.2), but
// browsers of the VRML97 era let programs read them.
const InterfaceDeclaration* readable(const vrml::NodeType& type, const std::string& name) {
  if (const InterfaceDeclaration* found = type.find_event_out(name)) return found;
  if (const InterfaceDeclaration* found = type.find_field(name)) return found;
  constexpr std::string_view kSet = "set_";
  if (name.starts_with(kSet))
    if (const InterfaceDeclaration* found = type.find_field(name.substr(kSet.size()))) return found;
  const InterfaceDeclaration* found = type.find(name + "_changed");
  return found && found->access == AccessType::eventOut ? found : nullptr;
}

class NodeHandler : public LiveProxyHandler {
 public:
  constexpr NodeHandler() : LiveProxyHandler(&kFamily) {}
  static constexpr char kFamily = 'N';

  void finalize(JS::GCContext*, JSObject* proxy) const override {
    auto* const box = static_cast<NodeBox*>(js::GetProxyPrivate(proxy).toPrivate());
    if (const auto own = box->link->objects.find(box->node); own != box->link->objects.end() && own->second == proxy)
      box->link->objects.erase(own);
    box->link->release(box->node);
    delete box;
  }
  bool ownPropertyKeys(JSContext* context, JS::HandleObject proxy, JS::MutableHandleIdVector keys) const override {
    const vrml::NodeType* const type = readable_type(context, *node_of(proxy));
    if (!type) return true;
    for (const InterfaceDeclaration& one : type->interfaces) {
      JS::RootedString name(context, JS_AtomizeString(context, one.name.c_str()));
      JS::RootedId id(context);
      if (!name || !JS_StringToId(context, name, &id) || !keys.append(id)) return false;
    }
    return true;
  }
  bool getOwnPropertyDescriptor(JSContext* context, JS::HandleObject proxy, JS::HandleId id,
                                JS::MutableHandle<mozilla::Maybe<JS::PropertyDescriptor>> found) const override {
    found.reset();
    bool known = false;
    if (!has(context, proxy, id, &known)) return false;
    bool inherited = false;
    if (!has_inherited(context, proxy, id, &inherited)) return false;
    if (!known || inherited) return true;
    JS::RootedValue value(context), receiver(context, JS::ObjectValue(*proxy));
    if (!get(context, proxy, receiver, id, &value)) return false;
    found.set(mozilla::Some(JS::PropertyDescriptor::Data(
        value,
        {JS::PropertyAttribute::Enumerable, JS::PropertyAttribute::Writable, JS::PropertyAttribute::Configurable})));
    return true;
  }
  bool has(JSContext* context, JS::HandleObject proxy, JS::HandleId id, bool* found) const override {
    std::string name;
    if (!name_of_id(context, id, name)) return false;
    NodeBox& box = *node_of(proxy);
    const vrml::NodeType* const type = type_in_world(context, box);
    *found = type && !name.empty() && (event_in(*type, name) || (readable(*type, name) && may_read(context, box)));
    if (*found) return true;
    return has_inherited(context, proxy, id, found);
  }
  bool get(JSContext* context, JS::HandleObject proxy, JS::HandleValue receiver, JS::HandleId id,
           JS::MutableHandleValue result) const override {
    std::string name;
    if (!name_of_id(context, id, name)) return false;
    NodeBox& box = *node_of(proxy);
    const vrml::NodeType* const type = type_in_world(context, box);
    const InterfaceDeclaration* const declaration = type && !name.empty() ? readable(*type, name) : nullptr;
    if (declaration && !may_read(context, box)) {
      result.setUndefined();
      return true;
    }
    if (!declaration) return get_inherited(context, proxy, id, receiver, result);
    World& world = world_of(context);
    if (!world.calls().changed().flush(context)) return false;
    const std::uint32_t place = place_of(*type, *declaration);
    std::optional<vrml::FieldValue> value;
    if (const vrml::FieldValue* const posted = world.calls().posted().find(box.node, place))
      value = *posted;
    else
      value = value_of(world, box, place);
    if (!value) {
      result.setUndefined();
      return true;
    }
    const bool writable = declaration->access == AccessType::exposedField;
    const Source source = writable ? Source{proxy, place} : Source{};
    if (declaration->type == vrml::FieldType::MFNode && declaration->slot >= 0)
      world.calls().posted().apply_to_children(box.node, *type, place, *value);
    return to_value(context, box.node.scene, *value, source, result);
  }
  bool set(JSContext* context, JS::HandleObject proxy, JS::HandleId id, JS::HandleValue value, JS::HandleValue,
           JS::ObjectOpResult& result) const override {
    std::string name;
    if (!name_of_id(context, id, name)) return false;
    const vrml::NodeType* const type = type_in_world(context, *node_of(proxy));
    if (!type) return result.succeed();
    const InterfaceDeclaration* const declaration = event_in(*type, name);
    if (!declaration) {
      warn(context, type->name + " has no eventIn '" + name.substr(0, 80) + "'; not set");
      return result.succeed();
    }
    return set_node_field(context, proxy, place_of(*type, *declaration), value) && result.succeed();
  }
};

constexpr char NodeHandler::kFamily;
const ContainedHandler<NodeHandler> kNodeHandler;

// Puts a text of elements into the document that the XML encoding of X3D demands.
std::string document_of(std::string text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || text[first] != '<') return text;
  for (const char* const root : {"<?", "<!", "<X3D"})
    if (text.compare(first, std::string_view(root).size(), root) == 0) return text;
  return "<X3D profile='Immersive' version='3.3'><Scene>" + text + "</Scene></X3D>";
}

bool construct(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  if (args.length() == 0 || args[0].isNullOrUndefined()) {
    args.rval().setObjectOrNull(JS_NewPlainObject(context));
    return args.rval().isObject();
  }
  if (args[0].isObject() && node_of(&args[0].toObject())) {
    args.rval().set(args[0]);
    return true;
  }
  std::string text;
  vrml::MFNode nodes;
  std::uint64_t scene = 0;
  if (!text_of_value(context, args[0], text)) return false;
  if (library_of(context).language == vrml::Language::x3d) text = document_of(std::move(text));
  if (!nodes_from_text(context, std::move(text), nodes, scene)) return false;
  if (nodes.empty()) return fail(context, "expected the text of a node");
  return node_to_value(context, {scene, nodes[0]}, args.rval());
}

// Returns text as in C.6.6.4: "If the browser is unable to reproduce this node, the name of the node followed by the
// open brace and close brace".
bool to_text(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  NodeBox* const box = args.thisv().isObject() ? node_of(&args.thisv().toObject()) : nullptr;
  const vrml::NodeType* const type = box ? readable_type(context, *box) : nullptr;
  return make_string(context, type ? type->name + " { }" : std::string("NULL"), args.rval());
}

// Returns the name of the node type. Later worlds call this function by its names in the SAI.
bool type_name(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  NodeBox* const box = args.thisv().isObject() ? node_of(&args.thisv().toObject()) : nullptr;
  const vrml::NodeType* const type = box ? readable_type(context, *box) : nullptr;
  return make_string(context, type ? type->name : std::string(), args.rval());
}
bool node_name(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  NodeBox* const box = args.thisv().isObject() ? node_of(&args.thisv().toObject()) : nullptr;
  const vrml::NodeType* const type = box ? readable_type(context, *box) : nullptr;
  return make_string(context, type ? world_of(context).view().ask({Ask::name, box->node}).text : std::string(),
                     args.rval());
}

const JSFunctionSpec kMethods[] = {JS_FN("toString", contained<to_text>, 0, 0),
                                   JS_FN("getNodeTypeName", contained<type_name>, 0, 0),
                                   JS_FN("getType", contained<type_name>, 0, 0),
                                   JS_FN("getNodeType", contained<type_name>, 0, 0),
                                   JS_FN("getName", contained<node_name>, 0, 0),
                                   JS_FN("getNodeName", contained<node_name>, 0, 0),
                                   JS_FS_END};

}  // namespace

bool define_nodes(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes) {
  JS::RootedObject prototype(context, JS_NewPlainObject(context));
  JSFunction* const function = JS_NewFunction(context, contained<construct>, 1, JSFUN_CONSTRUCTOR, "SFNode");
  JS::RootedObject constructor(context, function ? JS_GetFunctionObject(function) : nullptr);
  if (!prototype || !constructor || !JS_DefineFunctions(context, prototype, kMethods)) return false;
  if (!JS_LinkConstructorAndPrototype(context, constructor, prototype)) return false;
  prototypes[static_cast<std::size_t>(vrml::FieldType::SFNode)] = prototype;
  return JS_DefineProperty(context, library, "SFNode", constructor, 0);
}

NodeBox* node_of(JSObject* object) {
  if (!js::IsProxy(object) || js::GetProxyHandler(object) != &kNodeHandler) return nullptr;
  return static_cast<NodeBox*>(js::GetProxyPrivate(object).toPrivate());
}

bool may_read(JSContext* context, NodeBox& box) {
  World& world = world_of(context);
  const std::uint64_t running = world.calls().running().serial;
  if (box.readable_by == running) return true;
  if (!world.view().ask({Ask::may_read, box.node}).good) return false;
  box.readable_by = running;
  return true;
}

JSObject* object_of_node(JSContext* context, const NodeRef& node) {
  ScriptLibrary& library = library_of(context);
  auto& objects = library.link->objects;
  if (const auto known = objects.find(node); known != objects.end()) return known->second;
  auto box = std::make_unique<NodeBox>(NodeBox{library.link, node});
  JS::RootedValue place(context, JS::PrivateValue(box.get()));
  JSObject* const made = js::NewProxyObject(context, &kNodeHandler, place, library.prototype(vrml::FieldType::SFNode));
  if (!made) return nullptr;
  (void)box.release();
  library.link->hold(node);
  objects[node] = made;
  return made;
}

bool node_to_value(JSContext* context, const NodeRef& node, JS::MutableHandleValue value) {
  value.setNull();
  if (!node || !library_of(context).link->lives(node.scene)) return true;
  JSObject* const object = object_of_node(context, node);
  value.setObjectOrNull(object);
  return object != nullptr;
}

NodeRef node_of_value(JS::HandleValue value) {
  const NodeBox* const box = value.isObject() ? node_of(&value.toObject()) : nullptr;
  return box && box->lives() ? box->node : NodeRef{};
}

bool set_node_field(JSContext* context, JS::HandleObject object, std::uint32_t place, JS::HandleValue value) {
  NodeBox& box = *node_of(object);
  const vrml::NodeType* const type = type_in_world(context, box);
  if (!type || place >= type->interfaces.size()) return true;
  const InterfaceDeclaration& declaration = type->interfaces[place];
  // An event to the url of a Script replaces its program.
  const bool sets_program = vrml::has(type->role, vrml::Role::script) && declaration.name == "url";
  if (sets_program && !may_read(context, box)) return true;
  vrml::FieldValue field;
  if (!to_field(context, value, declaration.type, box.node.scene, field)) return false;
  World& world = world_of(context);
  if (!std::exchange(world.calls().running().told_direct, true)) world.view().tell({Notice::Kind::direct_output});
  return world.calls().posted().add(context, box.node, place, declaration, std::move(field));
}

bool nodes_from_text(JSContext* context, std::string text, vrml::MFNode& nodes, std::uint64_t& scene) {
  constexpr std::size_t kMaxCreated = std::size_t{4} << 20;  // max bytes of a text of nodes
  World& world = world_of(context);
  if (text.size() > kMaxCreated)
    return fail_range(context, "a text of " + std::to_string(text.size()) + " bytes is too long to create nodes from");
  Question question{Ask::create_nodes};
  question.text = std::move(text);
  Answer answer = world.view().ask(question);
  if (!answer.good) return fail(context, answer.text);
  if (auto* const made = std::get_if<vrml::MFNode>(&answer.value)) nodes = std::move(*made);
  scene = answer.node.scene;
  world.engine().note_nodes(answer.place);
  // Make an object for each node now. The object holds the node, so that garbage collection cannot remove it.
  for (const vrml::NodeId id : nodes)
    if (id && !object_of_node(context, {scene, id})) return false;
  return true;
}

}  // namespace gs::app::script
