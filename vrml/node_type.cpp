#include "vrml/node_type.h"

#include "vrml/scene_graph.h"

#include <utility>

namespace gs::vrml {
namespace {

constexpr std::string_view kSetPrefix = "set_";
constexpr std::string_view kChangedSuffix = "_changed";

}  // namespace

std::string_view name_of(AccessType access) {
  switch (access) {
    case AccessType::eventIn: return "eventIn";
    case AccessType::eventOut: return "eventOut";
    case AccessType::field: return "field";
    case AccessType::exposedField: return "exposedField";
  }
  return {};
}

NodeType::NodeType() = default;
NodeType::~NodeType() = default;

void NodeType::declare(InterfaceDeclaration declaration) {
  if (declaration.access == AccessType::field || declaration.access == AccessType::exposedField) {
    declaration.slot = static_cast<int>(defaults.size());
    defaults.push_back(declaration.initial);
  }
  interfaces.push_back(std::move(declaration));
}

const InterfaceDeclaration* NodeType::find(std::string_view wanted) const {
  for (const InterfaceDeclaration& declaration : interfaces)
    if (declaration.name == wanted) return &declaration;
  return nullptr;
}

const InterfaceDeclaration* NodeType::find_field(std::string_view wanted) const {
  for (const InterfaceDeclaration& declaration : interfaces)
    if (declaration.slot >= 0 && declaration.name == wanted) return &declaration;
  return nullptr;
}

const InterfaceDeclaration* NodeType::find_event_out(std::string_view wanted) const {
  for (const InterfaceDeclaration& declaration : interfaces)
    if ((declaration.access == AccessType::eventOut || declaration.access == AccessType::exposedField) &&
        declaration.name == wanted)
      return &declaration;
  if (!wanted.ends_with(kChangedSuffix)) return nullptr;
  const InterfaceDeclaration* exposed = find(wanted.substr(0, wanted.size() - kChangedSuffix.size()));
  return exposed && exposed->access == AccessType::exposedField ? exposed : nullptr;
}

const InterfaceDeclaration* NodeType::find_event_in(std::string_view wanted) const {
  for (const InterfaceDeclaration& declaration : interfaces)
    if ((declaration.access == AccessType::eventIn || declaration.access == AccessType::exposedField) &&
        declaration.name == wanted)
      return &declaration;
  if (!wanted.starts_with(kSetPrefix)) return nullptr;
  const InterfaceDeclaration* exposed = find(wanted.substr(kSetPrefix.size()));
  return exposed && exposed->access == AccessType::exposedField ? exposed : nullptr;
}

}  // namespace gs::vrml
