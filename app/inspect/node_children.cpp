#include "app/inspect/node_children.h"

namespace gs::app {

bool is_in(const vrml::Execution& world, const NodeAt& node) {
  return node && world.scenes().has(node.scene) && node.scene->contains(node.id);
}

void held_nodes(const vrml::Execution& world, const NodeAt& at, std::vector<HeldNodes>& held) {
  held.clear();
  if (!at) {
    const vrml::SceneGraph& root = world.scenes().root();
    if (!root.roots().empty()) held.push_back({0, {}, &root, root.roots().span(), true});
    return;
  }
  if (!is_in(world, at)) return;
  const vrml::Node& node = at.scene->node(at.id);
  for (std::size_t i = 0; i < node.type->interfaces.size() && i < HeldNodes::kContent; ++i) {
    const vrml::InterfaceDeclaration& one = node.type->interfaces[i];
    if (one.slot < 0 || !vrml::holds_nodes(one.type)) continue;
    const vrml::FieldValue& value = node.values[one.slot];
    HeldNodes group{static_cast<std::uint16_t>(i), one.name, at.scene, {}, false};
    if (const auto* single = std::get_if<vrml::SFNode>(&value)) {
      if (*single) group.nodes = {single, 1};
    } else if (const auto* list = std::get_if<vrml::MFNode>(&value)) {
      group.nodes = list->span();
      group.list = true;
    }
    if (!group.nodes.empty()) held.push_back(group);
  }
  if (!node.expansion.empty())
    held.push_back({HeldNodes::kBody, "body", at.scene, node.expansion.span(), node.expansion.size() > 1});
  if (const vrml::SceneGraph* const content = at.scene->inlines().of(at.id);
      content && world.scenes().has(content) && !content->roots().empty())
    held.push_back({HeldNodes::kContent, "content", content, content->roots().span(), true});
}

}  // namespace gs::app
