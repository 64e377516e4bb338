#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/scene/node_type.h"

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Interface of a node type in the form that event delivery needs. Names are looked up once per type.
struct EventSchema {
  static constexpr std::uint32_t kNone = UINT32_MAX;

  struct Interface {
    const InterfaceDeclaration* declaration = nullptr;
    std::int32_t slot = -1;   // index of the stored value: of an exposedField, or of field x for eventIn set_x
    std::int32_t out = -1;    // eventOut: index among the node's eventOut values
    std::int32_t event = -1;  // index in Behaviour::events
  };

  explicit EventSchema(const NodeType& node_type);
  /// Returns the index in `interfaces` of a declaration of this type; kNone for a declaration of another type.
  [[nodiscard]] std::uint32_t find(const InterfaceDeclaration& declaration) const;

  const NodeType* type = nullptr;
  const Behaviour* behaviour = nullptr;
  std::size_t users = 0;              // number of nodes; at 0, the schema of a type that the world declares is freed
  bool instance = false;              // the type is a PROTO: events pass on to nodes of the body
  std::vector<Interface> interfaces;  // in the order of the type's declarations
  std::vector<FieldType> outs;        // types of the eventOut values
  std::array<std::uint32_t, Behaviour::kMaxEvents> events{};  // indices in `interfaces` of Behaviour::events, or kNone

 private:
  // Index by declaration; used only for large interfaces.
  std::unordered_map<const InterfaceDeclaration*, std::uint32_t> places_;
};

}  // namespace gs::vrml
