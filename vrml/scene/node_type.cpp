#include "vrml/scene/node_type.h"

#include "vrml/scene/scene_graph.h"

#include <algorithm>
#include <utility>

namespace gs::vrml {
namespace {

// Number of interfaces from which on a table finds them. Built-in types have fewer.
constexpr std::size_t kManyInterfaces = 64;

constexpr std::string_view kSetPrefix = "set_";
constexpr std::string_view kChangedSuffix = "_changed";

std::uint32_t digest(std::string_view name) {
  if (name.empty()) return 0;
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(name[i])); };
  return static_cast<std::uint32_t>(name.size() & 0xff) << 24 | byte(0) << 16 | byte(name.size() / 2) << 8 |
         byte(name.size() - 1);
}

}  // namespace

std::string_view name_of(AccessType access, Language language) {
  static constexpr std::string_view kNames[] = {"eventIn", "eventOut", "field", "exposedField"};
  static constexpr std::string_view kX3dNames[] = {"inputOnly", "outputOnly", "initializeOnly", "inputOutput"};
  return (language == Language::x3d ? kX3dNames : kNames)[static_cast<std::size_t>(access)];
}

NodeType::NodeType() = default;
NodeType::~NodeType() = default;

void NodeType::declare(InterfaceDeclaration declaration) {
  if (declaration.access == AccessType::field || declaration.access == AccessType::exposedField) {
    declaration.slot = static_cast<int>(defaults.size());
    defaults.push_back(declaration.initial);
  }
  keys_.push_back(digest(declaration.name));
  interfaces.push_back(std::move(declaration));
  if (interfaces.size() < kManyInterfaces) return;
  if (by_name_.empty())
    for (const InterfaceDeclaration& each : interfaces) by_name_.emplace(each.name, &each);
  by_name_.emplace(interfaces.back().name, &interfaces.back());
}

std::vector<const InterfaceDeclaration*> NodeType::url_fields() const {
  std::vector<const InterfaceDeclaration*> fields;
  for (const InterfaceDeclaration& each : interfaces)
    if (each.slot >= 0 && each.type == FieldType::MFString && (each.name == "url" || each.name.ends_with("Url")))
      fields.push_back(&each);
  return fields;
}

const InterfaceDeclaration* NodeType::search(std::string_view wanted) const {
  if (!by_name_.empty()) {
    const auto found = by_name_.find(wanted);
    return found == by_name_.end() ? nullptr : found->second;
  }
  const std::uint32_t key = digest(wanted);
  for (std::size_t i = 0; i < keys_.size(); ++i)
    if (keys_[i] == key && interfaces[i].name == wanted) return &interfaces[i];
  return nullptr;
}

const InterfaceDeclaration* NodeType::find(std::string_view wanted) const {
  const InterfaceDeclaration* const found = search(wanted);
  if (found || language != Language::x3d) return found;
  // Only interfaces of the node table have other names. They precede those that a node declares.
  for (std::size_t i = 0; i < std::min(interfaces.size(), kManyInterfaces); ++i) {
    const InterfaceDeclaration& each = interfaces[i];
    if ((!each.x3d_name.empty() && each.x3d_name == wanted) ||
        (!each.former_name.empty() && each.former_name == wanted))
      return &each;
  }
  return nullptr;
}

const InterfaceDeclaration* NodeType::find_field(std::string_view wanted) const {
  const InterfaceDeclaration* found = find(wanted);
  return found && found->slot >= 0 ? found : nullptr;
}

const InterfaceDeclaration* NodeType::find_event_out(std::string_view wanted) const {
  const InterfaceDeclaration* found = find(wanted);
  if (found && (found->access == AccessType::eventOut || found->access == AccessType::exposedField)) return found;
  if (!wanted.ends_with(kChangedSuffix)) return nullptr;
  found = find(wanted.substr(0, wanted.size() - kChangedSuffix.size()));
  return found && found->access == AccessType::exposedField ? found : nullptr;
}

const InterfaceDeclaration* NodeType::find_event_in(std::string_view wanted) const {
  const InterfaceDeclaration* found = find(wanted);
  if (found && (found->access == AccessType::eventIn || found->access == AccessType::exposedField)) return found;
  if (wanted.starts_with(kSetPrefix)) {
    found = find(wanted.substr(kSetPrefix.size()));
    return found && found->access == AccessType::exposedField ? found : nullptr;
  }
  if (found || kind != Kind::built_in) return nullptr;
  found = find(std::string(kSetPrefix) + std::string(wanted));
  return found && found->access == AccessType::eventIn ? found : nullptr;
}

}  // namespace gs::vrml
