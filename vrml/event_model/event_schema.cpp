#include "vrml/event_model/event_schema.h"

namespace gs::vrml {
namespace {

constexpr std::size_t kFewInterfaces = 24;
constexpr std::string_view kSetOf = "set_";

}  // namespace

EventSchema::EventSchema(const NodeType& node_type)
    : type(&node_type),
      behaviour(node_type.behaviour),
      instance(node_type.kind == NodeType::Kind::prototype || node_type.kind == NodeType::Kind::external_prototype) {
  events.fill(kNone);
  for (const InterfaceDeclaration& declaration : node_type.interfaces) {
    Interface made{&declaration, declaration.slot};
    const std::string_view name = declaration.name;
    if (declaration.access == AccessType::eventOut) {
      made.out = static_cast<std::int32_t>(outs.size());
      outs.push_back(declaration.type);
    } else if (declaration.access == AccessType::eventIn && node_type.kind == NodeType::Kind::built_in &&
               name.starts_with(kSetOf)) {
      const InterfaceDeclaration* field = node_type.find_field(name.substr(kSetOf.size()));
      if (field && field->type == declaration.type) made.slot = field->slot;
    }
    for (std::size_t i = 0; behaviour && i < behaviour->events.size(); ++i)
      if (!name.empty() && behaviour->events[i] == name) {
        made.event = static_cast<std::int32_t>(i);
        events[i] = static_cast<std::uint32_t>(interfaces.size());
      }
    interfaces.push_back(made);
  }
  for (std::uint32_t i = 0; interfaces.size() > kFewInterfaces && i < interfaces.size(); ++i)
    places_.emplace(interfaces[i].declaration, i);
}

std::uint32_t EventSchema::find(const InterfaceDeclaration& declaration) const {
  if (!places_.empty()) {
    const auto found = places_.find(&declaration);
    return found == places_.end() ? kNone : found->second;
  }
  for (std::uint32_t i = 0; i < interfaces.size(); ++i)
    if (interfaces[i].declaration == &declaration) return i;
  return kNone;
}

}  // namespace gs::vrml
