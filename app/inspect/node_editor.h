#pragma once

#include "app/inspect/node_children.h"
#include "vrml/events/execution.h"
#include "vrml/scene/node_names.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Values of the selected node, and edits of them as events. Functions that send return a message, and send nothing, if
/// the value is invalid. Use on the world's thread.
class NodeEditor {
 public:
  /// Edits nodes of this world from now on, and drops pending edits. Null means no world.
  void set_world(vrml::Execution* world);
  void select(const NodeAt& node) { node_ = node; }

  /// Returns the value of an interface; null for an eventIn. Valid until the world's next step.
  [[nodiscard]] const vrml::FieldValue* value_of(const vrml::InterfaceDeclaration& interface) const;
  /// Send an event, from VRML97 text or a value.
  [[nodiscard]] std::optional<std::string> send_text(const vrml::InterfaceDeclaration& event_in,
                                                     const std::string& text);
  [[nodiscard]] std::optional<std::string> send(const vrml::InterfaceDeclaration& event_in, vrml::FieldValue value);
  /// Send a list with one element replaced.
  [[nodiscard]] std::optional<std::string> send_element(const vrml::InterfaceDeclaration& event_in,
                                                        const vrml::FieldValue& list, std::size_t index,
                                                        const vrml::FieldValue& element);
  [[nodiscard]] std::optional<std::string> send_element_text(const vrml::InterfaceDeclaration& event_in,
                                                             const vrml::FieldValue& list, std::size_t index,
                                                             const std::string& text);
  /// Resolves a url, so that the caller can open it. Returns nullopt if it cannot be resolved.
  [[nodiscard]] std::optional<std::string> target_of_url(const vrml::InterfaceDeclaration& url,
                                                         std::size_t index) const;
  /// Returns the node if it is a Script, in which lines of the console run; else null.
  [[nodiscard]] NodeAt script() const;

  /// Sends the pending events to their nodes. Returns false if there were none.
  bool deliver();
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
  std::unique_ptr<vrml::NodeNames> names_;  // null until an edit names a node
  std::vector<Edit> edits_;
};

}  // namespace gs::app
