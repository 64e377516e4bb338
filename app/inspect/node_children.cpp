#include "app/inspect/node_children.h"

namespace gs::app {

namespace {

constexpr int kMaxDepthOfName = 12;
constexpr std::size_t kMaxOfName = 64;  // max children that are searched per node

std::span<const vrml::NodeId> nodes_of(const vrml::FieldValue& value) {
  if (const auto* single = std::get_if<vrml::SFNode>(&value)) return {single, *single ? 1u : 0u};
  const auto* list = std::get_if<vrml::MFNode>(&value);
  return list ? list->span() : std::span<const vrml::NodeId>();
}

// Finds the node that names the content of `id`. `left` limits the number of visited nodes.
std::string name_of_content(const vrml::SceneGraph& scene, vrml::NodeId id, int depth, std::size_t& left) {
  if (!scene.contains(id) || depth > kMaxDepthOfName || left == 0) return {};
  --left;
  const vrml::Node& node = scene.node(id);
  if (depth > 0 && !node.name.empty()) return std::string(node.name);
  if (vrml::has(node.type->role, vrml::Role::geometry)) return node.type->name;
  if (depth > 0 && node.type->kind == vrml::NodeType::Kind::prototype) return node.type->name;
  if (node.type->read_as == vrml::NodeKind::inline_node) {
    const auto& urls = scene.get<vrml::MFString>(id, "url");
    if (!urls.empty()) return std::string(urls[0].view().substr(urls[0].view().rfind('/') + 1));
  }
  std::string name;
  for (const vrml::InterfaceDeclaration& one : node.type->interfaces) {
    if (one.slot < 0 || !vrml::holds_nodes(one.type) || one.name == "appearance") continue;
    const auto nodes = nodes_of(node.values[one.slot]);
    for (std::size_t i = 0; i < nodes.size() && i < kMaxOfName && name.empty(); ++i)
      name = name_of_content(scene, nodes[i], depth + 1, left);
    if (name.empty() && depth == 0 && !nodes.empty() && scene.contains(nodes[0]))
      name = scene.node(nodes[0]).type->name;
    if (name.empty()) continue;
    return nodes.size() > 1 && depth == 0 ? name + ", " + std::to_string(nodes.size() - 1) + " more" : name;
  }
  return name;
}

}  // namespace

std::string content_name(const NodeAt& at) {
  if (!at || !at.scene->contains(at.id)) return {};
  const vrml::Node& node = at.scene->node(at.id);
  const bool groups = vrml::has(node.type->role, vrml::Role::grouping) || node.type->read_as == vrml::NodeKind::shape;
  if (!node.name.empty() || !groups) return {};
  std::size_t left = kMaxOfName;
  return name_of_content(*at.scene, at.id, 0, left);
}

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
  const vrml::GeoTiles* const tiles = at.scene->inlines().tiles_of(at.id);
  if (const vrml::MFNode* const shown = tiles ? tiles->shown() : nullptr)
    held.push_back({HeldNodes::kContent, "content", at.scene, shown->span(), true});
  if (const vrml::SceneGraph* const content = at.scene->inlines().of(at.id);
      content && world.scenes().has(content) && !content->roots().empty())
    held.push_back({HeldNodes::kContent, "content", content, content->roots().span(), true});
}

}  // namespace gs::app
