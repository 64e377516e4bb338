#pragma once

#include "vrml/events/behaviour.h"
#include "vrml/scene/node_type.h"

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// The interface of a node type as events need it: names looked up once a type.
struct EventSchema {
  static constexpr std::uint32_t kNone = UINT32_MAX;

  struct Interface {
    const InterfaceDeclaration* declaration = nullptr;
    std::int32_t slot = -1;   // of the value: of exposedFields, and of the field x that eventIn set_x replaces
    std::int32_t out = -1;    // of an eventOut: place among the node's eventOut values
    std::int32_t event = -1;  // place in Behaviour::events
  };

  explicit EventSchema(const NodeType& node_type);
  /// Place of a declaration of the type in `interfaces`; kNone for one of another type.
  [[nodiscard]] std::uint32_t find(const InterfaceDeclaration& declaration) const;

  const NodeType* type = nullptr;
  const Behaviour* behaviour = nullptr;
  std::size_t users = 0;              // nodes; without any the schema of a type of the world's own goes
  bool instance = false;              // of a PROTO: events pass on to the nodes of the body
  std::vector<Interface> interfaces;  // in the order of the type's
  std::vector<FieldType> outs;        // of eventOut values
  std::array<std::uint32_t, Behaviour::kMostEvents> events{};  // places in `interfaces` of Behaviour::events, or kNone

 private:
  std::unordered_map<const InterfaceDeclaration*, std::uint32_t> places_;  // where there are many
};

}  // namespace gs::vrml
