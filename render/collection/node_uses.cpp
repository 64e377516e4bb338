#include "render/collection/node_uses.h"

#include <algorithm>

namespace gs::render {
namespace {

std::span<const NodeUse> uses_of(const std::vector<NodeUse>& uses, const vrml::Node* node) {
  const auto [first, last] =
      std::equal_range(uses.begin(), uses.end(), NodeUse{node, 0},
                       [](const NodeUse& a, const NodeUse& b) { return std::less<>()(a.node, b.node); });
  return {first, last};
}

}  // namespace

void NodeUses::forget() {
  frames_known_ = items_known_ = false;
  frames_.clear();
  items_.clear();
}

std::span<const NodeUse> NodeUses::of_frame(const vrml::Node* node, const RenderSources& sources) {
  if (!frames_known_) list_frames(sources);
  frames_known_ = true;
  return uses_of(frames_, node);
}

std::span<const NodeUse> NodeUses::of_item(const vrml::Node* node, const RenderList& list,
                                           const RenderSources& sources) {
  if (!items_known_) list_items(list, sources);
  items_known_ = true;
  return uses_of(items_, node);
}

void NodeUses::list_frames(const RenderSources& sources) {
  for (std::uint32_t i = 1; i < sources.frames.size(); ++i) frames_.push_back({sources.frames[i].node, i});
  for (const RenderSources::Unshown& unshown : sources.unshown) frames_.push_back({unshown.node, NodeUse::kUnshown});
  std::sort(frames_.begin(), frames_.end());
}

void NodeUses::list_items(const RenderList& list, const RenderSources& sources) {
  const auto scene_at = [&](std::uint32_t place) { return place == kNoPlace ? nullptr : list.places[place].scene; };
  for (std::uint32_t i = 0; i < sources.items.size(); ++i) add_item(sources.items[i], scene_at(list.items[i].place), i);
  for (std::uint32_t i = 0; i < sources.splats.size(); ++i)
    add_item(sources.splats[i], scene_at(list.splats[i].place), i | NodeUse::kSplat);
  for (const RenderSources::Unshown& unshown : sources.unshown)
    add_geometry(unshown.node, unshown.scene, NodeUse::kUnshown);
  for (const RenderSources::Volume& volume : sources.volumes)
    for (const vrml::Node* node : volume.nodes) add(node, volume.item);
  std::sort(items_.begin(), items_.end());
}

void NodeUses::add(const vrml::Node* node, std::uint32_t index) {
  if (node) items_.push_back({node, index});
}

// A geometry depends on the nodes in its fields: coordinates, colours, a FontStyle.
void NodeUses::add_geometry(const vrml::Node* geometry, const vrml::SceneGraph* scene, std::uint32_t index) {
  add(geometry, index);
  if (!geometry || !scene) return;
  for (std::size_t i = 0; i < geometry->type->defaults.size(); ++i)
    if (const auto* property = std::get_if<vrml::SFNode>(&geometry->values[i]))
      if (const vrml::NodeId id = scene->resolve(*property)) add(&scene->node(id), index);
}

// Nodes of X3D refer to further nodes: textures, TextureProperties, generators of coordinates.
void NodeUses::add_inner(const vrml::Node* node, const vrml::SceneGraph& scene, std::uint32_t index) {
  if (!node || node->type->language != vrml::Language::x3d) return;
  for (const vrml::Node* inner : inner_nodes(scene, *node)) {
    add(inner, index);
    for (const vrml::Node* innermost : inner_nodes(scene, *inner)) add(innermost, index);
  }
}

void NodeUses::add_item(const RenderSources::Item& source, const vrml::SceneGraph* scene, std::uint32_t index) {
  const ShapeResources::AppearanceNodes& nodes = source.appearance;
  for (const vrml::Node* node :
       {nodes.material, nodes.texture, nodes.texture_transform, nodes.line, nodes.fill, nodes.point})
    add(node, index);
  if (scene)
    for (const vrml::Node* node :
         {nodes.appearance, nodes.material, nodes.texture, nodes.texture_transform, source.geometry})
      add_inner(node, *scene, index);
  add_geometry(source.geometry, scene, index);
}

std::vector<const vrml::Node*> inner_nodes(const vrml::SceneGraph& scene, const vrml::Node& node) {
  constexpr std::size_t kMaxNodes = 64;
  std::vector<const vrml::Node*> nodes;
  const auto add = [&](vrml::NodeId id) {
    id = scene.resolve(id);
    if (id && nodes.size() < kMaxNodes) nodes.push_back(&scene.node(id));
  };
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i) {
    if (const auto* one = std::get_if<vrml::SFNode>(&node.values[i])) add(*one);
    if (const auto* several = std::get_if<vrml::MFNode>(&node.values[i]))
      for (const vrml::NodeId id : *several) add(id);
  }
  return nodes;
}

}  // namespace gs::render
