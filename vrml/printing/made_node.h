#pragma once

#include "vrml/scene/node_type.h"

#include <memory>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Node that a printer makes in place of a node that VRML97 lacks. Its values may contain nodes of the scene.
struct MadeNode {
  struct Field {
    const InterfaceDeclaration* declaration = nullptr;  // in `type`
    FieldValue value;
    std::unique_ptr<MadeNode> node;  // node in place of the value
  };

  explicit MadeNode(const NodeType& made_type) : type(made_type) {}

  /// Sets a field of `type`.
  void set(std::string_view field, FieldValue value) {
    fields.push_back({type.find(field), std::move(value), nullptr});
  }
  void set(std::string_view field, MadeNode node) {
    fields.push_back({type.find(field), {}, std::make_unique<MadeNode>(std::move(node))});
  }

  const NodeType& type;
  std::vector<Field> fields;
};

}  // namespace gs::vrml
