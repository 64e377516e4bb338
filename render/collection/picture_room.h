#pragma once

#include "render/collection/shapes/shape_resources.h"
#include "render/scene/render_list.h"

#include <array>
#include <cstddef>
#include <memory>
#include <unordered_map>

namespace gs::render {

/// Items and triangles that a picture still has room for. With USE and PROTO, a small file can describe 2^n objects.
class PictureRoom {
 public:
  PictureRoom(ShapeResources& resources, std::shared_ptr<Budget> budget);

  [[nodiscard]] bool has_item(const RenderList& list) const {
    return list.items.size() < budget_->limit(Resource::items);
  }
  /// Takes the room for one item with this number of triangles. Reports a limit that refuses it, and returns false.
  [[nodiscard]] bool take_item(const RenderList& list, std::size_t triangles, const vrml::SceneGraph& scene,
                               vrml::NodeId geometry);
  /// Takes the room for triangles. Returns false if there is none.
  [[nodiscard]] bool take_triangles(std::size_t count);
  /// Takes the room for an item with a primitive; `finest` is its finest mesh. Returns as take_item().
  [[nodiscard]] bool take_primitive(const RenderList& list, const std::shared_ptr<const vrml::Mesh>& finest,
                                    const vrml::SceneGraph& scene, vrml::NodeId geometry);
  /// If all primitives have too many triangles, replaces their meshes by coarser ones.
  void coarsen_primitives(RenderList& list) const;

 private:
  /// Items of one primitive.
  struct Primitives {
    std::array<std::shared_ptr<const vrml::Mesh>, ShapeResources::kSegments.size()> meshes;
    std::size_t count = 0;
  };
  ShapeResources& resources_;
  std::shared_ptr<Budget> budget_;
  std::size_t triangles_ = 0;  // triangles of all items; primitives count with their coarsest mesh
  std::unordered_map<const vrml::Mesh*, Primitives> primitives_;  // by the finest mesh
};

}  // namespace gs::render
