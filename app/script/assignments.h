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
  PostedEvents(WorldView& view, Engine& engine) : view_(view), engine_(engine) {}

  /// Stores an event. Only the last event of each eventIn is kept, except for MFNode eventIns, which add or remove
  /// nodes. Throws an exception and returns false if memory is insufficient.
  /// `place` is the index of the eventIn, `event_in`, in the interfaces of the node's type.
  bool add(JSContext* context, const NodeRef& node, std::uint32_t place, const vrml::InterfaceDeclaration& event_in,
           vrml::FieldValue value);
  /// Returns the value of the stored event for an eventIn; null if there is none.
  [[nodiscard]] const vrml::FieldValue* find(const NodeRef& node, std::uint32_t place) const;
  /// Applies the stored addChildren and removeChildren events of a node to `value`, the value of the interface `place`.
  void apply_to_children(const NodeRef& node, const vrml::NodeType& type, std::uint32_t place,
                         vrml::FieldValue& value) const;
  /// Sends the changed values, the eventOuts of `program` and the stored events to the world. Removes these events.
  void send_all(Program& program);

 private:
  struct Post {
    NodeRef node;
    std::uint32_t place;
    vrml::FieldValue value;
  };

  WorldView& view_;
  Engine& engine_;
  std::vector<Post> posts_;
  std::size_t bytes_ = 0;  // bytes of values in posts_
  std::unordered_map<PlaceRef, std::size_t, HashPlaceRef> last_;
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
