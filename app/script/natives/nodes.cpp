#include "app/script/bounds/bounded_natives.h"
#include "app/script/bounds/contained.h"
#include "app/script/natives.h"
#include "app/script/natives/live_proxy.h"
#include "app/script/run_time_nodes.h"
#include "app/script/script_world.h"
#include "vrml/scene/scene_graph.h"

#include <js/Conversions.h>
#include <js/Object.h>
#include <js/PropertySpec.h>
#include <js/Proxy.h>
#include <jsfriendapi.h>

#include <algorithm>
#include <utility>

// SFNode (VRML97 C.6.6). The eventIns, eventOuts and exposedFields of a node are properties (C.5.2). Each library has
// at most one object for a node, so that comparing objects compares nodes. The object holds the node as long as it
// exists.
namespace gs::app::script {
namespace {

using vrml::AccessType;
using vrml::InterfaceDeclaration;

NodeKey key_of(const NodeBox& box) { return {box.scene.serial(), box.id}; }

// Returns the name of a property in `name`; empty for a symbol or index.
bool name_of_id(JSContext* context, JS::HandleId id, std::string& name) {
  name.clear();
  if (!id.isString()) return true;
  JS::RootedValue value(context, JS::StringValue(id.toString()));
  return text_of_value(context, value, name);
}

// Returns the node of an SFNode object; null if the node is no longer part of the world.
const vrml::Node* node_in_world(const NodeBox& box) {
  const vrml::SceneGraph* const scene = box.live_scene();
  return scene ? &scene->node(box.id) : nullptr;
}

// Returns the node of an SFNode object. Returns null if it is no longer part of the world, or if the running program
// may not read it.
const vrml::Node* readable_node(JSContext* context, const NodeBox& box) {
  const vrml::Node* const node = node_in_world(box);
  return node && may_read(context, *node) ? node : nullptr;
}

std::uint32_t place_of(const vrml::NodeType& type, const InterfaceDeclaration& declaration) {
  std::uint32_t place = 0;
  for (const InterfaceDeclaration& one : type.interfaces) {
    if (&one == &declaration) break;
    ++place;
  }
  return place;
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
    if (const auto own = box->link->objects.find(key_of(*box)); own != box->link->objects.end() && own->second == proxy)
      box->link->objects.erase(own);
    if (vrml::SceneGraph* const scene = box->scene.in(box->link.get()))
      box->link->execution->lifetime().release(*scene, box->id);
    delete box;
  }
  bool ownPropertyKeys(JSContext* context, JS::HandleObject proxy, JS::MutableHandleIdVector keys) const override {
    const vrml::Node* const node = readable_node(context, *node_of(proxy));
    if (!node) return true;
    for (const InterfaceDeclaration& one : node->type->interfaces) {
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
    const vrml::Node* const node = node_in_world(*node_of(proxy));
    *found = node && !name.empty() &&
             (event_in(*node->type, name) || (readable(*node->type, name) && may_read(context, *node)));
    if (*found) return true;
    return has_inherited(context, proxy, id, found);
  }
  bool get(JSContext* context, JS::HandleObject proxy, JS::HandleValue receiver, JS::HandleId id,
           JS::MutableHandleValue result) const override {
    std::string name;
    if (!name_of_id(context, id, name)) return false;
    const NodeBox& box = *node_of(proxy);
    const vrml::Node* const node = node_in_world(box);
    const InterfaceDeclaration* const declaration = node && !name.empty() ? readable(*node->type, name) : nullptr;
    if (declaration && !may_read(context, *node)) {
      result.setUndefined();
      return true;
    }
    if (!declaration) return get_inherited(context, proxy, id, receiver, result);
    World& world = world_of(context);
    if (!world.calls().changed().flush(context)) return false;
    vrml::SceneGraph* const scene = box.live_scene();  // again, because flushing may have run code of the program
    if (!scene) return true;
    const vrml::FieldValue* value = world.calls().posted().find(*scene, box.id, *declaration);
    if (!value) value = world.execution().cascade().last_value(*scene, box.id, *declaration);
    if (!value) {
      result.setUndefined();
      return true;
    }
    const bool writable = declaration->access == AccessType::exposedField;
    const Source source = writable ? Source{proxy, place_of(*node->type, *declaration)} : Source{};
    vrml::FieldValue copy = *value;
    if (declaration->type == vrml::FieldType::MFNode && declaration->slot >= 0)
      world.calls().posted().apply_to_children(*scene, box.id, *declaration, copy);
    return to_value(context, scene, copy, source, result);
  }
  bool set(JSContext* context, JS::HandleObject proxy, JS::HandleId id, JS::HandleValue value, JS::HandleValue,
           JS::ObjectOpResult& result) const override {
    std::string name;
    if (!name_of_id(context, id, name)) return false;
    const NodeBox& box = *node_of(proxy);
    const vrml::Node* const node = node_in_world(box);
    if (!node) return result.succeed();
    const InterfaceDeclaration* const declaration = event_in(*node->type, name);
    if (!declaration) {
      warn(context, node->type->name + " has no eventIn '" + name.substr(0, 80) + "'; not set");
      return result.succeed();
    }
    return set_node_field(context, proxy, place_of(*node->type, *declaration), value) && result.succeed();
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
  vrml::SceneGraph* scene = nullptr;
  if (!text_of_value(context, args[0], text)) return false;
  if (library_of(context).language == vrml::Language::x3d) text = document_of(std::move(text));
  if (!nodes_from_text(context, text, nodes, scene)) return false;
  if (nodes.empty()) return fail(context, "expected the text of a node");
  JSObject* const made = object_of_node(context, *scene, nodes[0]);
  args.rval().setObjectOrNull(made);
  return made != nullptr;
}

// Returns text as in C.6.6.4: "If the browser is unable to reproduce this node, the name of the node followed by the
// open brace and close brace".
bool to_text(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const NodeBox* const box = args.thisv().isObject() ? node_of(&args.thisv().toObject()) : nullptr;
  const vrml::Node* const node = box ? readable_node(context, *box) : nullptr;
  return make_string(context, node ? node->type->name + " { }" : std::string("NULL"), args.rval());
}

// Returns the name of the node type. Later worlds call this function by its names in the SAI.
bool type_name(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const NodeBox* const box = args.thisv().isObject() ? node_of(&args.thisv().toObject()) : nullptr;
  const vrml::Node* const node = box ? readable_node(context, *box) : nullptr;
  return make_string(context, node ? node->type->name : std::string(), args.rval());
}
bool node_name(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const NodeBox* const box = args.thisv().isObject() ? node_of(&args.thisv().toObject()) : nullptr;
  const vrml::Node* const node = box ? readable_node(context, *box) : nullptr;
  return make_string(context, node ? std::string(node->name) : std::string(), args.rval());
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

bool sets_program(const vrml::NodeType& type, const InterfaceDeclaration& event_in) {
  return vrml::has(type.role, vrml::Role::script) && event_in.name == "url";
}

JSObject* object_of_node(JSContext* context, vrml::SceneGraph& scene, vrml::NodeId id) {
  World& world = world_of(context);
  ScriptLibrary& library = library_of(context);
  auto& objects = library.link->objects;
  auto box = std::make_unique<NodeBox>(NodeBox{library.link, &scene, id});
  const NodeKey key = key_of(*box);
  if (const auto known = objects.find(key); known != objects.end()) return known->second;
  JS::RootedValue place(context, JS::PrivateValue(box.get()));
  JSObject* const made = js::NewProxyObject(context, &kNodeHandler, place, library.prototype(vrml::FieldType::SFNode));
  if (!made) return nullptr;
  (void)box.release();
  world.execution().lifetime().hold(scene, id);
  objects[key] = made;
  return made;
}

bool set_node_field(JSContext* context, JS::HandleObject object, std::uint32_t place, JS::HandleValue value) {
  const NodeBox& box = *node_of(object);
  const vrml::Node* const node = node_in_world(box);
  if (!node || place >= node->type->interfaces.size()) return true;
  const InterfaceDeclaration& declaration = node->type->interfaces[place];
  if (sets_program(*node->type, declaration) && !may_read(context, *node)) return true;
  vrml::SceneGraph* scene = box.live_scene();
  vrml::FieldValue field;
  if (!to_field(context, value, declaration.type, scene, field)) return false;
  scene = box.live_scene();  // get it again, because the conversion may have run code of the program
  if (!scene) return true;
  World& world = world_of(context);
  world.messages().report_direct_output(world.calls().running());
  return world.calls().posted().add(context, *scene, box.id, declaration, std::move(field));
}

bool nodes_from_text(JSContext* context, std::string_view text, vrml::MFNode& nodes, vrml::SceneGraph*& scene) {
  constexpr std::size_t kMaxCreated = std::size_t{4} << 20;  // max bytes of a text of nodes
  constexpr std::size_t kWorthCollecting = 64;               // min nodes to count for one text of nodes
  constexpr std::size_t kTextOfNode = 16;                    // min bytes of text for a node
  World& world = world_of(context);
  Program& program = world.calls().running();
  scene = program.scene;
  if (text.size() > kMaxCreated)
    return fail_range(context, "a text of " + std::to_string(text.size()) + " bytes is too long to create nodes from");
  if (!world.calls().may_act()) return fail(context, "shutdown() cannot create nodes");
  Diagnostics diagnostics;
  vrml::RunTimeNodes made =
      make_nodes(world.execution(), *scene, label_of(program), text, diagnostics, &text_of_program(program));
  for (const Diagnostic& one : diagnostics.entries()) world.messages().report(one);
  if (made.outcome == vrml::ParseOutcome::refused) return fail(context, "not VRML97 text");
  world.engine().note_nodes(std::max({kWorthCollecting, made.roots.size(), text.size() / kTextOfNode}));
  nodes = std::move(made.roots);
  // Make an object for each node now. The object holds the node, so that garbage collection cannot remove it.
  for (const vrml::NodeId id : nodes)
    if (!object_of_node(context, *scene, id)) return false;
  return true;
}

}  // namespace gs::app::script
