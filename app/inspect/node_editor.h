#pragma once

#include "app/inspect/node_children.h"
#include "app/session/documents/world_edits.h"
#include "vrml/events/execution.h"
#include "vrml/scene/node_names.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Editor of the selected node. Shows its values, and sends edits as events. If a value is invalid, the send functions
/// return a message and send nothing. World's thread.
class NodeEditor {
 public:
  /// Sets the world with the nodes to edit. Drops edits that are not sent yet. Null means no world.
  void set_world(vrml::Execution* world);
  void select(const NodeAt& node) { node_ = node; }

  /// Returns the value of an interface, or null for an eventIn. Valid until the next step of the world.
  [[nodiscard]] const vrml::FieldValue* value_of(const vrml::InterfaceDeclaration& interface) const;
  /// Send an event. The value is VRML97 text in the first function.
  [[nodiscard]] std::optional<std::string> send_text(const vrml::InterfaceDeclaration& event_in,
                                                     const std::string& text);
  [[nodiscard]] std::optional<std::string> send(const vrml::InterfaceDeclaration& event_in, vrml::FieldValue value);
  /// Send `list` with one element replaced. The element is VRML97 text in the second function.
  [[nodiscard]] std::optional<std::string> send_element(const vrml::InterfaceDeclaration& event_in,
                                                        const vrml::FieldValue& list, std::size_t index,
                                                        const vrml::FieldValue& element);
  [[nodiscard]] std::optional<std::string> send_element_text(const vrml::InterfaceDeclaration& event_in,
                                                             const vrml::FieldValue& list, std::size_t index,
                                                             const std::string& text);
  /// Returns the absolute URL of one element of a url field, so that the caller can open it. Returns nullopt if the URL
  /// cannot be resolved.
  [[nodiscard]] std::optional<std::string> target_of_url(const vrml::InterfaceDeclaration& url,
                                                         std::size_t index) const;
  /// Returns the selected node if it is a Script, in which input lines of the console run. Otherwise returns a null
  /// node.
  [[nodiscard]] NodeAt script() const;

  /// Sends all events of edits to their nodes, and records those that change fields in `edits`. Returns false if there
  /// were none.
  bool deliver(WorldEdits& edits);
  /// Undoes (-1) or redoes (1) an edit in `edits`. Returns false if there is none.
  bool step(WorldEdits& edits, int direction);
  /// Ends a gesture, such as a drag. Edits of one field during a gesture count as one edit.
  void end_gesture() { ++gesture_; }
  [[nodiscard]] bool pending() const { return !edits_.empty(); }

 private:
  struct Edit {
    NodeAt node;
    const vrml::InterfaceDeclaration* event_in;
    vrml::FieldValue value;
  };
  [[nodiscard]] vrml::NodeNames& names();

  vrml::Execution* world_ = nullptr;
  NodeAt node_;
  std::unique_ptr<vrml::NodeNames> names_;  // null until an edit refers to a node by name
  std::vector<Edit> edits_;
  std::uint64_t gesture_ = 1;
};

}  // namespace gs::app
