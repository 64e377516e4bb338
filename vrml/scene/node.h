#pragma once

#include "vrml/scene/node_type.h"
#include "vrml/scene/source_text.h"
#include "vrml/scene/x3d/x3d_statements.h"

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Node: its type, and one value for each slot of the type.
struct Node {
  const NodeType* type = nullptr;
  FieldValue* values = nullptr;      // type->defaults.size() values, which the scene owns
  std::string_view name;             // DEF name or empty; the text owns the bytes
  const SourceText* text = nullptr;  // text in which the node was written; for a copy, the text of the PROTO's body
  SourceLocation location;
  std::uint32_t value_capacity = 0;
  std::uint32_t generation = 0;    // generation of its NodeId
  std::uint64_t fields_set = 0;    // EXTERNPROTO instances: one bit per slot below 64 with an explicit value
  bool in_prototype_body = false;  // belongs to the declaration of a PROTO, not to the world
  bool recycled = false;           // another node had its index before
  bool strings_set = false;        // an event has set an MFString field
  std::uint32_t owner = 0;         // index of the run-time text that it was made for; 0 means the file
  MFNode expansion;                // PROTO instances: copies of the body's nodes; the first one represents the instance
  /// PROTO instances: index of the copy of Prototype::nodes[0]; the other copies follow. Nodes in the body of a PROTO:
  /// index in Prototype::nodes.
  std::uint32_t expansion_first = 0;
  std::uint32_t instance = 0;  // copies in a PROTO instance: index of the instance
};

/// Returns the field `load` of an X3D node with urls (ISO/IEC 19775-1 9.3.2). Returns null for other types.
[[nodiscard]] inline const InterfaceDeclaration* load_field(const NodeType& type) {
  if (type.kind != NodeType::Kind::built_in || type.url_content == UrlContent::none) return nullptr;
  const InterfaceDeclaration* const load = type.find_field("load");
  return load && load->type == FieldType::SFBool ? load : nullptr;
}
/// Reports whether the urls of a node may be loaded: `load` is TRUE, or the type has no such field.
[[nodiscard]] inline bool may_load(const Node& node) {
  const InterfaceDeclaration* const load = load_field(*node.type);
  return !load || *std::get_if<SFBool>(&node.values[load->slot]);
}

/// IS statement in the body of a PROTO: `field IS name` (VRML97 4.8.2).
struct IsMapping {
  NodeId node;
  const InterfaceDeclaration* inner = nullptr;  // declaration in the node's type
  const InterfaceDeclaration* outer = nullptr;  // declaration in the PROTO's interface
};

/// Body of a PROTO. Each instance gets copies of its nodes.
struct Prototype {
  std::vector<Statement> statements;
  std::vector<NodeId> nodes;  // all nodes in the order of creation; see SceneGraph::put_in_body
  std::vector<IsMapping> mappings;
  std::shared_ptr<X3DStatements> shared{};  // IMPORTs of the body, and ROUTEs of imported nodes; null if there are none
  const SceneGraph* scene = nullptr;        // scene with these nodes in its arena
  const SourceText* text = nullptr;         // text that declares the PROTO
  bool complete = false;                    // the closing brace was read
  // Number of nodes and bytes of one instance, including nested instances. Set if complete.
  std::uint64_t instance_nodes = 0, instance_bytes = 0;
  std::uint64_t body_bytes = 0;  // bytes without nested instances
};

}  // namespace gs::vrml
