#include "render/scene/mesh_cache.h"

#include <utility>

namespace gs::render {

void MeshCache::forget(const vrml::Node* node) {
  if (vrml::has(node->type->role, vrml::Role::geometry)) {
    meshes.erase(node);
    return;
  }
  for (const vrml::Node* geometry : std::exchange(unlisted_, {})) {
    const auto entry = meshes.find(geometry);
    if (entry == meshes.end()) continue;
    for (std::size_t i = 0; i < geometry->type->defaults.size(); ++i)
      if (const auto* part = std::get_if<vrml::SFNode>(&geometry->values[i]))
        if (const vrml::NodeId id = entry->second.scene->resolve(*part))
          geometries_of_.insert({&entry->second.scene->node(id), geometry});
  }
  for (auto each = geometries_of_.lower_bound({node, nullptr}); each != geometries_of_.end() && each->first == node;
       ++each)
    meshes.erase(each->second);
}

}  // namespace gs::render
