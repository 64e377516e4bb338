#include "render/rays/mesh_trees.h"

#include <thread>
#include <utility>

namespace gs::render {

void MeshTrees::prepare(const std::shared_ptr<const vrml::Mesh>& mesh) {
  if (mesh->primitive != vrml::Mesh::Primitive::triangles || mesh->indices.size() / 3 < kLargeMesh) return;
  if (asked_ <= 0) return;
  --asked_;
  auto tree = std::make_shared<Tree>();
  tree->tree.emplace(*mesh);
  tree->ready = true;
  const std::lock_guard lock(mutex_);
  std::erase_if(prepared_, [](const auto& one) { return one.second.mesh.expired(); });
  prepared_[mesh.get()] = {mesh, std::move(tree)};
}

std::shared_ptr<MeshTrees::Tree> MeshTrees::find(const std::shared_ptr<const vrml::Mesh>& mesh) {
  ask();
  {
    const std::lock_guard lock(mutex_);
    const auto known = prepared_.extract(mesh.get());
    if (known && !known.mapped().mesh.owner_before(mesh) && !mesh.owner_before(known.mapped().mesh))
      return std::move(known.mapped().tree);
  }
  auto tree = std::make_shared<Tree>();
  // The thread owns its data. No code waits for it, even at the end of the program.
  std::thread([tree, mesh] {
    tree->tree.emplace(*mesh);
    tree->ready = true;
  }).detach();
  return tree;
}

}  // namespace gs::render
