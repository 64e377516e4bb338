#pragma once

#include "app/script/boundary/program_host.h"
#include "app/script/boundary/world_view.h"
#include "app/script/engine/engine.h"
#include "app/script/habits/contact_habits.h"

#include <jsapi.h>

#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

// Programs of Scripts, and the data of their objects. Each Script has its own global object, so names without `var`
// belong to one Script. The objects of VRML97's types form a library, which the Scripts of one site or local file share
// (read_rule.h). They know the world only through WorldView.
namespace gs::app::script {

class World;
struct ScriptLibrary;

/// Attributes of properties that can be enumerated but not deleted.
constexpr unsigned kProperty = JSPROP_ENUMERATE | JSPROP_PERMANENT;

/// Script and its program.
struct Program {
  World* world = nullptr;
  ScriptLibrary* library = nullptr;
  vrml::EventNode node = 0;
  std::uint64_t serial = 0;  // unique among all programs of the host
  std::shared_ptr<const ProgramFacts> facts;
  /// Values of fields and eventOuts, by index in the node type's interfaces. `changed` are those that the world does
  /// not know yet.
  std::vector<vrml::FieldValue> values;
  std::vector<bool> changed;
  std::vector<std::uint32_t> to_tell;
  JS::PersistentRootedObject global;
  std::vector<jsid> names;                                         // by index in the node type's interfaces
  std::vector<std::unique_ptr<JS::PersistentRootedObject>> lists;  // objects of MF fields and eventOuts, by the index
                                                                   // of `names`
  std::vector<bool> unsent;                                        // eventOuts with unsent values; by index of `names`
  std::vector<std::uint32_t> to_send;
  std::vector<std::size_t> counted;  // by index of `names`: bytes that count against the heap of programs
  bool runs = false, off = false, has_processed = false, has_prepare = false, told_direct = false;
  int faults = 0;
  UndeclaredNames undeclared;

  [[nodiscard]] const vrml::InterfaceDeclaration& interface(std::uint32_t place) const {
    return facts->type->interfaces[place];
  }
  /// Returns the scene of the Script.
  [[nodiscard]] std::uint64_t scene() const { return facts->node.scene; }
  [[nodiscard]] vrml::Language language() const { return facts->language; }
};

/// Part of a library that outlives its world, because objects may be collected later.
struct Link {
  WorldView* view = nullptr;                                    // null after the world is destroyed
  std::unordered_map<NodeRef, JSObject*, HashNodeRef> objects;  // objects of nodes

  [[nodiscard]] bool lives(std::uint64_t scene) const { return view && view->lives(scene); }
  void hold(const NodeRef& node) const {
    if (view && node) view->hold(node);
  }
  void release(const NodeRef& node) const {
    if (node && lives(node.scene)) view->release(node);
  }
};

/// Data of an SFNode object. The node is held as long as the object exists.
struct NodeBox {
  std::shared_ptr<Link> link;
  NodeRef node;
  std::shared_ptr<const vrml::NodeType> type{};  // null until it was asked for
  std::uint64_t readable_by = 0;                 // serial of the last program that was allowed to read the node

  /// Reports whether the node is part of the world.
  [[nodiscard]] bool lives() const { return link->lives(node.scene); }
};

/// Data of an MF object: of a Script's own field or eventOut, or a separate value.
struct ListBox {
  std::shared_ptr<Link> link{};
  Engine* engine = nullptr;
  Program* program = nullptr;  // owner of the field or eventOut; null for a separate value
  std::uint32_t place = 0;
  vrml::FieldType type = vrml::FieldType::MFInt32;
  std::uint64_t scene = 0;   // scene of the nodes of an MFNode
  vrml::FieldValue value{};  // unused if there is a `program`
  std::vector<vrml::NodeId> held{};
  std::size_t counted = 0;  // bytes that count against the heap of programs
  bool changed = false;     // the value must still be sent to the node or image from which the list was read
};

/// Objects of VRML97's types and of the browser. They have their own compartment.
struct ScriptLibrary {
  World* world = nullptr;
  vrml::Language language = vrml::Language::vrml97;  // of its Scripts
  std::shared_ptr<Link> link = std::make_shared<Link>();
  JS::PersistentRootedObject global;
  std::vector<JS::PersistentRootedObject> prototypes;
  std::unordered_map<std::string, std::string> options;  // values of Browser.setOption()

  ScriptLibrary(World& of, WorldView& view, JSContext* context);
  [[nodiscard]] JSObject* prototype(vrml::FieldType type) const { return prototypes[static_cast<std::size_t>(type)]; }
  [[nodiscard]] JSObject* matrix_prototype() const { return prototypes[kMatrixPrototype]; }
  [[nodiscard]] JSObject* row_prototype() const { return prototypes[kRowPrototype]; }
  static constexpr int kMatrixPrototype = vrml::kFieldTypeCount, kRowPrototype = kMatrixPrototype + 1;
};

/// Returns the library of the calling program. world_of() returns its world.
[[nodiscard]] ScriptLibrary& library_of(JSContext* context);
[[nodiscard]] World& world_of(JSContext* context);
[[nodiscard]] Program* program_of_global(JSObject* global);

}  // namespace gs::app::script
