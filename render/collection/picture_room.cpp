#include "render/collection/picture_room.h"

#include <algorithm>
#include <utility>

namespace gs::render {
namespace {

// Above this number of triangles, primitives get the finest mesh that still fits, or the coarsest.
constexpr std::size_t kManyTriangles = std::size_t{1} << 24;

}  // namespace

PictureRoom::PictureRoom(ShapeResources& resources, std::shared_ptr<Budget> budget)
    : resources_(resources), budget_(std::move(budget)) {}

bool PictureRoom::take_item(const RenderList& list, std::size_t triangles, const vrml::SceneGraph& scene,
                            vrml::NodeId geometry) {
  if (!has_item(list)) {
    resources_.report_limit(budget_->refusal(Resource::items), scene, geometry);
    return false;
  }
  if (!take_triangles(triangles)) {
    resources_.report_limit(budget_->refusal(Resource::triangles), scene, geometry);
    return false;
  }
  return true;
}

bool PictureRoom::take_triangles(std::size_t count) {
  const std::size_t most = budget_->limit(Resource::triangles);
  if (count > most - std::min(most, triangles_)) return false;
  triangles_ += count;
  return true;
}

bool PictureRoom::take_primitive(const RenderList& list, const std::shared_ptr<const vrml::Mesh>& finest,
                                 const vrml::SceneGraph& scene, vrml::NodeId geometry) {
  Primitives& all = primitives_[finest.get()];
  for (std::size_t i = 0; all.count == 0 && i < all.meshes.size(); ++i)
    all.meshes[i] = resources_.primitive(scene, geometry, i);
  const vrml::Mesh& coarsest = *all.meshes[ShapeResources::kCoarsestPrimitive];
  if (!take_item(list, coarsest.indices.size() / 3, scene, geometry)) return false;
  ++all.count;
  return true;
}

void PictureRoom::coarsen_primitives(RenderList& list) const {
  std::size_t fineness = 0;
  for (; fineness < ShapeResources::kCoarsestPrimitive; ++fineness) {
    std::size_t triangles = 0;
    for (const auto& [finest, all] : primitives_) triangles += all.count * (all.meshes[fineness]->indices.size() / 3);
    if (triangles <= kManyTriangles) break;
  }
  if (fineness == 0) return;
  for (DrawItem& item : list.items)
    if (const auto known = primitives_.find(item.mesh.get()); known != primitives_.end())
      item.mesh = known->second.meshes[fineness];
}

}  // namespace gs::render
