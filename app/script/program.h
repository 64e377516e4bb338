#pragma once

#include "app/script/engine/engine.h"
#include "app/script/habits/contact_habits.h"
#include "app/script/read_rule.h"
#include "vrml/events/execution.h"

#include <jsapi.h>

#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

// Programs of Scripts, and the data of their objects. Each Script has its own global object, so names without `var`
// belong to one Script. The objects of VRML97's types form a library, which the Scripts of one site or local file share
// (read_rule.h).
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
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;
  vrml::Language language = vrml::Language::vrml97;  // of the text of the Script: selects the API
  std::shared_ptr<const vrml::TextSource> source;    // source of the text that contains the url field
  /// Cached decisions of may_read(), by the source of the node. The shared pointers keep the keys valid.
  std::unordered_map<const vrml::TextSource*, std::pair<std::shared_ptr<const vrml::TextSource>, Reading>> readings;
  JS::PersistentRootedObject global;
  std::vector<jsid> names;                                         // by index in the node type's interfaces
  std::vector<std::unique_ptr<JS::PersistentRootedObject>> lists;  // objects of MF fields and eventOuts, by the index
                                                                   // of `names`
  std::vector<bool> unsent;                                        // eventOuts with unsent values; by index of `names`
  std::vector<std::uint32_t> to_send;
  std::vector<std::size_t> counted;  // by index of `names`: bytes that count against the heap of programs
  bool runs = false, waits = false, off = false, has_processed = false, has_prepare = false, told_direct = false;
  bool ended = false;  // shutdown() was called
  int faults = 0;
  std::string late_message;  // see Engine::on_overdue()
  std::size_t next_url = 0;  // index of the first entry of the url field that was not tried yet
  UndeclaredNames undeclared;
};

/// Key of a node in any scene of a world. A NodeId alone is unique only within its scene.
struct NodeKey {
  std::uint64_t scene = 0;  // SceneGraph::serial
  vrml::NodeId id;
  friend bool operator==(const NodeKey&, const NodeKey&) = default;
};
struct HashNodeKey {
  std::size_t operator()(const NodeKey& key) const {
    return static_cast<std::size_t>(
        ((std::uint64_t{key.id.generation} << 32 | key.id.index) + key.scene * 0x85ebca6bU) * 0x9e3779b97f4a7c15U);
  }
};

/// Part of a library that outlives its world, because objects may be collected later.
struct Link {
  vrml::Execution* execution = nullptr;                         // null after the world is destroyed
  std::unordered_map<NodeKey, JSObject*, HashNodeKey> objects;  // objects of nodes
};

/// Scene to which a value of a program belongs. The scene may be removed during the life of the value.
class SceneRef {
 public:
  SceneRef() = default;
  SceneRef(vrml::SceneGraph* scene) : scene_(scene), serial_(scene ? scene->serial() : 0) {}
  /// Returns the scene; null if it is no longer part of the world.
  [[nodiscard]] vrml::SceneGraph* in(const Link* link) const {
    return scene_ && link && link->execution && link->execution->scenes().has(scene_) && scene_->serial() == serial_
               ? scene_
               : nullptr;
  }
  [[nodiscard]] std::uint64_t serial() const { return serial_; }

 private:
  vrml::SceneGraph* scene_ = nullptr;
  std::uint64_t serial_ = 0;
};

/// Data of an SFNode object. The node is held as long as the object exists.
struct NodeBox {
  std::shared_ptr<Link> link;
  SceneRef scene;
  vrml::NodeId id;
  /// Returns the node's scene; null if the node is no longer part of the world.
  [[nodiscard]] vrml::SceneGraph* live_scene() const {
    vrml::SceneGraph* const in_world = scene.in(link.get());
    return in_world && in_world->contains(id) ? in_world : nullptr;
  }
};

/// Data of an MF object: of a Script's own field or eventOut, or a separate value.
struct ListBox {
  std::shared_ptr<Link> link;
  Engine* engine = nullptr;
  Program* program = nullptr;  // owner of the field or eventOut; null for a separate value
  std::uint32_t place = 0;
  vrml::FieldType type = vrml::FieldType::MFInt32;
  SceneRef scene;          // scene of the nodes of an MFNode
  vrml::FieldValue value;  // unused if there is a `program`
  std::vector<vrml::NodeId> held;
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

  explicit ScriptLibrary(World& of, vrml::Execution& execution, JSContext* context);
  [[nodiscard]] JSObject* prototype(vrml::FieldType type) const { return prototypes[static_cast<std::size_t>(type)]; }
  [[nodiscard]] JSObject* matrix_prototype() const { return prototypes[kMatrixPrototype]; }
  [[nodiscard]] JSObject* row_prototype() const { return prototypes[kRowPrototype]; }
  static constexpr int kMatrixPrototype = vrml::kFieldTypeCount, kRowPrototype = kMatrixPrototype + 1;
};

/// Returns the library of the calling program. world_of() returns its world.
[[nodiscard]] ScriptLibrary& library_of(JSContext* context);
[[nodiscard]] World& world_of(JSContext* context);
[[nodiscard]] Program* program_of_global(JSObject* global);

/// Returns the text that contains the url field of a Script.
[[nodiscard]] const vrml::SourceText& text_of_program(const Program& program);
/// Returns the name of a Script in messages.
[[nodiscard]] std::string label_of(const Program& program);

}  // namespace gs::app::script
