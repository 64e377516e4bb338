// Part of Collector for the boxes of nodes with bboxDisplay TRUE (X3D 10.2.2).
#include "render/collection/collector.h"

#include <glm/glm.hpp>

#include <memory>
#include <utility>

namespace gs::render {
namespace {

template <class T>
T field_of(const vrml::Node& node, const char* name, T otherwise) {
  const vrml::InterfaceDeclaration* declaration = node.type->find_field(name);
  const T* value = declaration ? std::get_if<T>(&node.values[declaration->slot]) : nullptr;
  return value ? *value : otherwise;
}

}  // namespace

std::shared_ptr<const vrml::Mesh> edges_of(const Box& box) {
  vrml::Mesh mesh;
  mesh.primitive = vrml::Mesh::Primitive::lines;
  mesh.solid = mesh.lit = false;
  mesh.bounds = box;
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    const auto at = [&](int axis) { return corner >> axis & 1 ? box.upper[axis] : box.lower[axis]; };
    mesh.positions.push_back({at(0), at(1), at(2)});
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      if (corner >> axis & 1) continue;
      mesh.indices.push_back(corner);
      mesh.indices.push_back(corner | 1u << axis);
    }
  }
  return std::make_shared<const vrml::Mesh>(std::move(mesh));
}

Box box_of_items(const RenderList& list, std::size_t first, std::size_t end, const glm::dmat4& world_from_local) {
  Box box;
  const glm::dmat4 local_from_world = glm::inverse(world_from_local);
  for (std::size_t i = first; i < end; ++i) {
    const WideBox bounds = world_bounds(list.items[i].mesh->bounds, local_from_world * list.items[i].world_from_node);
    if (bounds.empty()) continue;
    box.add(glm::vec3(bounds.lower));
    box.add(glm::vec3(bounds.upper));
  }
  return box;
}

/// Adds the box of a node: the one that the node declares, or else the box of the items from `first_item` on.
void Collector::add_box(const vrml::Node& node, const glm::dmat4& world_from_local, std::size_t first_item,
                        std::uint32_t place, const Presence& presence) {
  if (!room_.has_item(list_) || !presence.visible) return;
  Box box;
  const auto size = field_of(node, "bboxSize", vrml::SFVec3f(-1)),
             center = field_of(node, "bboxCenter", vrml::SFVec3f(0));
  if (size.x >= 0 && size.y >= 0 && size.z >= 0) {
    box.add(center - size * 0.5f);
    box.add(center + size * 0.5f);
  } else {
    box = box_of_items(list_, first_item, list_.items.size(), world_from_local);
    if (sources_ && !box.empty() && place != kNoPlace)
      sources_->boxes.push_back(
          {static_cast<std::uint32_t>(list_.items.size()), static_cast<std::uint32_t>(first_item)});
  }
  if (box.empty()) return;
  DrawItem item;
  item.mesh = edges_of(box);
  item.world_from_node = world_from_local;
  item.material.emissive = {1, 1, 0};
  item.clip_planes = clip_planes(presence);
  item.local_fog = presence.local_fog;
  item.place = place;
  item.collidable = false;
  item.overlay = presence.overlay;
  RenderSources::Item source;
  source.bounds = world_bounds(box, world_from_local);
  if (!item.overlay && !source.bounds.empty()) list_.bounds.add(source.bounds);
  list_.items.push_back(std::move(item));
  if (sources_) sources_->items.push_back(source);
}

}  // namespace gs::render
