#pragma once

#include "app/script/program.h"

#include <jsapi.h>

#include <cstddef>
#include <unordered_map>
#include <vector>

// Assignments of a program that take effect after its function.
namespace gs::app::script {

/// Events for nodes that a function has assigned to, until the function ends (C.5.2, C.5.3). One thread.
class PostedEvents {
 public:
  /// Both arguments must outlive the object.
  PostedEvents(vrml::Execution& execution, Engine& engine) : execution_(execution), engine_(engine) {}

  /// Stores an event. Only the last event of each eventIn is kept, except for MFNode eventIns, which add or remove
  /// nodes. Throws an exception and returns false if memory is insufficient.
  bool add(JSContext* context, vrml::SceneGraph& scene, vrml::NodeId node, const vrml::InterfaceDeclaration& event_in,
           vrml::FieldValue value);
  /// Returns the value of the stored event for an eventIn; null if there is none.
  [[nodiscard]] const vrml::FieldValue* find(const vrml::SceneGraph& scene, vrml::NodeId node,
                                             const vrml::InterfaceDeclaration& event_in) const;
  /// Applies the stored addChildren and removeChildren events of a node to the value of its `children`.
  void apply_to_children(const vrml::SceneGraph& scene, vrml::NodeId node, const vrml::InterfaceDeclaration& children,
                         vrml::FieldValue& value) const;
  /// Removes the events, and sends the eventOuts of `program` and the events. If `discard`, sends none of them.
  void send_all(Program& program, bool discard);

 private:
  struct Key {
    NodeKey node;
    const vrml::InterfaceDeclaration* event_in;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct HashKey {
    std::size_t operator()(const Key& key) const {
      return HashNodeKey()(key.node) ^ std::hash<const void*>()(key.event_in);
    }
  };
  struct Post {
    vrml::SceneGraph* scene;
    vrml::NodeId node;
    const vrml::InterfaceDeclaration* event_in;
    vrml::FieldValue value;
  };

  vrml::Execution& execution_;
  Engine& engine_;
  std::vector<Post> posts_;
  std::size_t bytes_ = 0;  // bytes of values in posts_
  std::unordered_map<Key, std::size_t, HashKey> last_;
};

/// Lists that a function has changed and that were read from nodes. One thread.
class ChangedLists {
 public:
  explicit ChangedLists(JSContext* context) : lists_(context, JS::StackGCVector<JSObject*>(context)) {}

  /// Adds a list. Throws an exception and returns false if memory is insufficient.
  bool add(JSContext* context, JS::HandleObject list);
  /// Writes the lists back and removes them. Returns false after an exception.
  bool flush(JSContext* context);

 private:
  JS::PersistentRooted<JS::StackGCVector<JSObject*>> lists_;
};

}  // namespace gs::app::script
