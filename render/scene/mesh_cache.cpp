#include "render/scene/mesh_cache.h"

#include "render/scene/surface_mesh.h"

#include "render/scene/late_meshes.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace gs::render {

// Makes the mesh of an entry again. The old mesh stays visible until the new mesh is ready.
void MeshCache::renew(std::unordered_map<const vrml::Node*, Entry>::iterator entry) {
  if (entry == meshes.end()) return;
  if (!late) {
    meshes.erase(entry);
    return;
  }
  entry->second.stale = true;
  if (entry->second.finer)
    for (Entry& one : entry->second.finer->levels) one.stale = true;
}

void MeshCache::keep(Entry& entry, std::shared_ptr<vrml::Mesh> mesh, const std::shared_ptr<Budget>& budget) {
  entry.mesh = nullptr;
  entry.share = Share(budget, Resource::meshes);
  // The budget does not permit the mesh. Keep an empty mesh, so that further USEs do not try again.
  if (!entry.share.grow(mesh->cost())) {
    *mesh = {};
    mesh->limited = true;
  }
  entry.refused = mesh->limited && !budget->stopped();
  entry.mesh = std::move(mesh);
}

std::shared_ptr<const vrml::Mesh> MeshCache::surface_of(const std::shared_ptr<const qnv::Geometry>& geometry,
                                                        bool pictured) {
  SurfaceEntry& entry = surfaces[geometry.get()];
  if (entry.geometry.lock() != geometry) entry = {geometry, {}};
  if (entry.meshes[pictured]) return entry.meshes[pictured];
  const auto mesh = entry.meshes[pictured] = mesh_of_surface(*geometry, pictured);
  std::erase_if(surfaces, [](const auto& each) { return each.second.geometry.expired(); });
  return mesh;
}

void MeshCache::forget(const vrml::Node* node) {
  if (vrml::has(node->type->role, vrml::Role::geometry)) return renew(meshes.find(node));
  for (const vrml::Node* geometry : std::exchange(unlisted_, {})) {
    const auto entry = meshes.find(geometry);
    if (entry == meshes.end()) continue;
    for (std::size_t i = 0; i < geometry->type->defaults.size(); ++i)
      if (const auto* part = std::get_if<vrml::SFNode>(&geometry->values[i]))
        if (const vrml::NodeId id = entry->second.scene->resolve(*part)) {
          const vrml::Node& property = entry->second.scene->node(id);
          geometries_of_.insert({&property, geometry});
          if (property.type->read_as != vrml::NodeKind::multi_texture_coordinate) continue;
          for (const vrml::NodeId one : entry->second.scene->get<vrml::MFNode>(id, "texCoord"))
            if (const vrml::NodeId inner = entry->second.scene->resolve(one))
              geometries_of_.insert({&entry->second.scene->node(inner), geometry});
        }
  }
  for (auto each = geometries_of_.lower_bound({node, nullptr}); each != geometries_of_.end() && each->first == node;
       ++each)
    renew(meshes.find(each->second));
}

void MeshCache::forget_scene(const vrml::SceneGraph& scene) {
  for (auto each = meshes.begin(); each != meshes.end();) {
    const auto one = each++;
    if (one->second.scene == &scene) renew(one);
  }
}

void MeshCache::remove(const vrml::SceneGraph& scene, const vrml::Node* node) {
  meshes.erase(node);
  pixel_images.erase(node);
  volumes.erase(node);
  scene_cubes.erase(node);
  if (late) late->forget(node);
  if (geometries_of_.empty()) return;
  geometries_of_.erase(geometries_of_.lower_bound({node, nullptr}), geometries_of_.lower_bound({node + 1, nullptr}));
  for (std::size_t i = 0; i < node->type->defaults.size(); ++i)
    if (const auto* part = std::get_if<vrml::SFNode>(&node->values[i]))
      if (const vrml::NodeId id = scene.resolve(*part)) geometries_of_.erase({&scene.node(id), node});
}

void MeshCache::take(MeshCache&& other) {
  for (const auto& [geometry, entry] : other.meshes) made(geometry);
  meshes.merge(other.meshes);
  pixel_images.merge(other.pixel_images);
  volumes.merge(other.volumes);
  casts.merge(other.casts);
  scene_cubes.merge(other.scene_cubes);
  primitives.merge(other.primitives);
  other.clear();
}

void MeshCache::made(const vrml::Node* geometry) {
  constexpr std::size_t kFew = 1024;
  if (unlisted_.size() > kFew + 2 * meshes.size()) {
    std::sort(unlisted_.begin(), unlisted_.end(), std::less<>());
    unlisted_.erase(std::unique(unlisted_.begin(), unlisted_.end()), unlisted_.end());
    std::erase_if(unlisted_, [&](const vrml::Node* one) { return !meshes.contains(one); });
  }
  unlisted_.push_back(geometry);
}

}  // namespace gs::render
