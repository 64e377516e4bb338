#include "app/script/x3d/x3d_natives.h"

#include "app/script/bounds/contained.h"
#include "app/script/script_world.h"
#include "vrml/scene/x3d/x3d_components.h"

#include <js/Array.h>
#include <js/Object.h>
#include <js/PropertySpec.h>

#include <map>
#include <string>
#include <utility>

// Access to the nodes, PROTOs and ROUTEs of the text of the running program (ISO/IEC 19775-2 6.4). The first argument
// of most functions selects a text by one of its nodes. Null selects the program's own text. The world answers all of
// them (Ask).
namespace gs::app::script {
namespace {

// Returns an array of texts, numbers and objects.
bool give_items(JSContext* context, const JS::CallArgs& args, const std::vector<AnswerItem>& items) {
  JS::RootedValueVector values(context);
  for (const AnswerItem& item : items) {
    JS::RootedValue value(context);
    if (const auto* const number = std::get_if<double>(&item)) value = JS::NumberValue(*number);
    if (const auto* const text = std::get_if<std::string>(&item); text && !make_string(context, *text, &value))
      return false;
    if (const auto* const node = std::get_if<NodeRef>(&item); node && !node_to_value(context, *node, &value))
      return false;
    if (!values.append(value)) return false;
  }
  JSObject* const array = JS::NewArrayObject(context, JS::HandleValueArray(values));
  args.rval().setObjectOrNull(array);
  return array != nullptr;
}

bool give_list(JSContext* context, const JS::CallArgs& args, std::uint64_t scene, vrml::FieldValue value) {
  ListBox box;
  box.scene = scene;
  box.value = std::move(value);
  JSObject* const list = make_list(context, std::move(box), {});
  args.rval().setObjectOrNull(list);
  return list != nullptr;
}

/// Parts of an answer that a function returns.
enum class Gives : std::uint8_t { items, text, node, nodes, texts };
/// Second argument of a function.
enum class Takes : std::uint8_t { nothing, name, flag };

template <Ask kAsk, Gives kGives, Takes kTakes = Takes::nothing>
bool ask(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  Question question{kAsk, node_of_value(args.get(0))};
  if (kTakes == Takes::name && !text_of_value(context, args.get(1), question.text)) return false;
  if (kTakes == Takes::flag) question.flag = args.get(1).isTrue();
  Answer answer = world_of(context).view().ask(question);
  if (kAsk == Ask::x3d_create_instance) {
    if (!answer.good && !answer.text.empty()) return fail(context, answer.text);
    world_of(context).engine().note_nodes(answer.place);
  }
  switch (kGives) {
    case Gives::items:
      return give_items(context, args, answer.items);
    case Gives::text:
      return make_string(context, answer.text, args.rval());
    case Gives::node:
      return node_to_value(context, answer.node, args.rval());
    case Gives::nodes:
      if (!std::holds_alternative<vrml::MFNode>(answer.value)) answer.value = vrml::MFNode{};
      return give_list(context, args, answer.node.scene, std::move(answer.value));
    case Gives::texts:
      if (!std::holds_alternative<vrml::MFString>(answer.value)) answer.value = vrml::MFString{};
      return give_list(context, args, 0, std::move(answer.value));
  }
  return false;
}

// Returns the names of all node types and abstract types of X3D.
bool type_names(JSContext* context, unsigned argc, JS::Value* vp) {
  std::string names;
  for (const auto& type : vrml::built_in_node_types(vrml::Language::x3d)) names += type->bases + " " + type->name + " ";
  return make_string(context, names, JS::CallArgsFromVp(argc, vp).rval());
}

// Returns the name and the highest supported level of each component, one after the other.
bool components(JSContext* context, unsigned argc, JS::Value* vp) {
  std::map<std::string, int> levels;
  for (const auto& type : vrml::built_in_node_types(vrml::Language::x3d))
    if (const vrml::X3DComponent* const known = vrml::x3d_component_named(type->component);
        known && known->supported > 0)
      levels[type->component] = known->supported;
  std::vector<AnswerItem> items;
  for (const auto& [name, level] : levels) {
    items.emplace_back(name);
    items.emplace_back(static_cast<double>(level));
  }
  return give_items(context, JS::CallArgsFromVp(argc, vp), items);
}

// Replaces the top-level nodes of the file. Returns false if the program is not part of a file.
bool set_roots(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  World& world = world_of(context);
  Question question{Ask::x3d_set_roots};
  args.rval().setBoolean(false);
  if (!world.view().ask(question).flag) return true;  // without a value: asks whether the program may do it
  if (!to_field(context, args.get(0), vrml::FieldType::MFNode, world.calls().running().scene(), question.value))
    return false;
  args.rval().setBoolean(world.view().ask(question).good);
  return true;
}

const JSFunctionSpec kNatives[] = {
    JS_FN("$x3d_fields", (contained<ask<Ask::x3d_fields, Gives::items>>), 1, 0),
    JS_FN("$x3d_types", (contained<ask<Ask::x3d_types, Gives::text>>), 1, 0),
    JS_FN("$x3d_typeNames", contained<type_names>, 0, 0),
    JS_FN("$x3d_components", contained<components>, 0, 0),
    JS_FN("$x3d_named", (contained<ask<Ask::x3d_named, Gives::node, Takes::name>>), 2, 0),
    JS_FN("$x3d_roots", (contained<ask<Ask::x3d_roots, Gives::nodes>>), 1, 0),
    JS_FN("$x3d_setRoots", contained<set_roots>, 1, 0),
    JS_FN("$x3d_routes", (contained<ask<Ask::x3d_routes, Gives::items>>), 1, 0),
    JS_FN("$x3d_protos", (contained<ask<Ask::x3d_prototypes, Gives::items, Takes::flag>>), 2, 0),
    JS_FN("$x3d_protoFields", (contained<ask<Ask::x3d_prototype_fields, Gives::items, Takes::name>>), 2, 0),
    JS_FN("$x3d_protoUrls", (contained<ask<Ask::x3d_prototype_urls, Gives::texts, Takes::name>>), 2, 0),
    JS_FN("$x3d_createProto", (contained<ask<Ask::x3d_create_instance, Gives::node, Takes::name>>), 2, 0),
    JS_FN("$x3d_statedComponents", (contained<ask<Ask::x3d_stated_components, Gives::items>>), 1, 0),
    JS_FN("$x3d_metas", (contained<ask<Ask::x3d_metas, Gives::items>>), 1, 0),
    JS_FN("$x3d_exported", (contained<ask<Ask::x3d_exported, Gives::node, Takes::name>>), 2, 0),
    JS_FN("$x3d_context", (contained<ask<Ask::x3d_context, Gives::items>>), 1, 0),
    JS_FS_END};

}  // namespace

bool define_x3d_natives(JSContext* context, JS::HandleObject library) {
  return JS_DefineFunctions(context, library, kNatives);
}

}  // namespace gs::app::script
