#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/scene/node_type.h"

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Interfaces of a node type in the form that event delivery needs. Each name is looked up once per type.
struct EventSchema {
  static constexpr std::uint32_t kNone = UINT32_MAX;

  struct Interface {
    const InterfaceDeclaration* declaration = nullptr;
    std::int32_t slot = -1;   // index of the stored value: of an exposedField, or of field x for the eventIn set_x
    std::int32_t out = -1;    // for an eventOut: index among the eventOut values of a node
    std::int32_t event = -1;  // index in Behaviour::events
  };

  explicit EventSchema(const NodeType& node_type);
  /// Returns the index in `interfaces` of a declaration of this type. Returns kNone if another type has the
  /// declaration.
  [[nodiscard]] std::uint32_t find(const InterfaceDeclaration& declaration) const;

  /// Reports whether an event for an interface only calls a program: the interface is an eventIn of a Script.
  [[nodiscard]] bool calls_only(std::uint32_t place) const {
    return type->kind == NodeType::Kind::script && interfaces[place].slot < 0 && interfaces[place].event < 0;
  }

  const NodeType* type = nullptr;
  const Behaviour* behaviour = nullptr;
  std::size_t users = 0;              // number of nodes; at 0, a type of the world loses its schema
  bool instance = false;              // the type is a PROTO: its events also go to nodes of the body
  std::vector<Interface> interfaces;  // in the order of the type's declarations
  std::vector<FieldType> outs;        // types of the eventOut values
  std::array<std::uint32_t, Behaviour::kMaxEvents> events{};  // `interfaces` index of each name in Behaviour::events

 private:
  // Index in `interfaces` of each declaration; only for types with many interfaces.
  std::unordered_map<const InterfaceDeclaration*, std::uint32_t> places_;
};

}  // namespace gs::vrml
