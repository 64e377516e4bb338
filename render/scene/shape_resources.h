#pragma once

#include "render/scene/collect_nodes.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/text_shaper.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::render {

/// What Shapes are drawn with, made of their nodes once: meshes, materials, images. One thread; the scene, the images
/// and the cache must outlive it.
class ShapeResources {
 public:
  /// Segments of primitives, from fine to coarse. Those behind kCoarsestPrimitive are for what fills a few pixels.
  static constexpr std::array<int, 6> kSegments = {64, 32, 16, 8, 6, 4};
  static constexpr std::size_t kCoarsestPrimitive = 3;

  static constexpr std::size_t kCoarsestText = vrml::kTextBars;

  ShapeResources(const Images& images, MeshCache& meshes, std::shared_ptr<vrml::Budget> budget)
      : images_(images), meshes_(meshes), budget_(std::move(budget)) {}

  [[nodiscard]] Schemas& schemas() { return schemas_; }
  [[nodiscard]] const Images& images() const { return images_; }
  /// The nodes that an Appearance is made of; null where there is none of the kind.
  struct AppearanceNodes {
    const vrml::Node *appearance = nullptr, *material = nullptr, *texture = nullptr, *texture_transform = nullptr;
  };
  [[nodiscard]] AppearanceNodes appearance_nodes(const vrml::SceneGraph& scene, const NodeView& shape);
  /// Sets material and texture of the item.
  void dress(DrawItem& item, const vrml::SceneGraph& scene, const NodeView& shape);
  /// The mesh of a geometry node, made if it has not been; where another thread makes it (MeshCache::late), the former
  /// one until that is done. Null or empty: it shows nothing.
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> mesh_of(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                          bool textured);
  /// That of a Text as it is to be seen from `viewer`: the finer, the larger it is there, `level` of
  /// vrml::kTextTolerances. The coarsest one where there is no room for it.
  struct TextMesh {
    std::shared_ptr<const vrml::Mesh> mesh;
    std::uint8_t level;
  };
  [[nodiscard]] TextMesh text_mesh_of(const vrml::SceneGraph& scene, vrml::NodeId geometry, bool textured,
                                      std::size_t level);
  /// The mesh of vectors with triangles between them: of those that show its picture, or of the others.
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> surface_mesh(const std::shared_ptr<const qnv::Cloud>& cloud,
                                                               bool pictured) {
    return meshes_.surface_of(cloud, pictured);
  }
  /// The picture of a QNV node's surface (Cloud::picture), which is among the images of nodes; none while it is not.
  [[nodiscard]] TextureUse surface_texture(const vrml::Node& node, const qnv::Cloud& cloud) const;
  /// The mesh of a Box, Cone, Cylinder or Sphere of the default measures, with those that are coarser. `fineness`: of
  /// kSegments.
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> primitive(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                            std::size_t fineness);
  /// Whether a mesh was made since the last call.
  [[nodiscard]] bool take_made_mesh() { return std::exchange(made_mesh_, false); }
  void leave_out(const std::string& why, const vrml::SceneGraph& scene, vrml::NodeId node);
  [[nodiscard]] std::vector<LeftOut>& left_out() { return left_out_; }
  /// OutlineGroups are looked for again: which refines which may have changed.
  void forget_refiners() { refiners_.clear(); }

 private:
  TextureUse texture_use(const vrml::SceneGraph& scene, const NodeView& appearance);
  std::shared_ptr<const Image> image_of_texture(const vrml::SceneGraph& scene, vrml::NodeId texture);
  vrml::NodeId refiner_of(const vrml::SceneGraph& scene, vrml::NodeId geometry);
  void bring_up_to_date(MeshCache::Entry& entry, const vrml::SceneGraph& scene, vrml::NodeId geometry, bool textured,
                        std::size_t text_level);
  void make_mesh(MeshCache::Entry& entry, const vrml::SceneGraph& scene, vrml::NodeId geometry,
                 const vrml::MeshOptions& options);

  const Images& images_;
  MeshCache& meshes_;
  std::shared_ptr<vrml::Budget> budget_;
  Schemas schemas_;
  std::unordered_map<const vrml::SceneGraph*, std::unordered_map<std::uint32_t, vrml::NodeId>> refiners_;  // by index
  std::vector<LeftOut> left_out_;
  bool made_mesh_ = false;
};

/// How finely text is to be cut (a place in vrml::kTextTolerances), so that nobody sees corners in it: by how large its
/// font is at the nearest place of its box. `bounds` in world space. `pixels_per_radian`: of the picture, in its
/// middle. `pictures`: small text may be cut out of the picture of glyphs.
[[nodiscard]] std::size_t text_level(const vrml::Mesh& text, const glm::dmat4& world_from_node,
                                     const WorldBounds& bounds, const glm::dvec3& viewer, float pixels_per_radian,
                                     bool pictures);

}  // namespace gs::render
