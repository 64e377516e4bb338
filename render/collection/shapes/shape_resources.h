#pragma once

#include "render/collection/nodes/collect_nodes.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/text_shaper.h"
#include "vrml/scene/meant_node.h"

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

/// Resources of Shapes, made once per node: meshes, materials, images. One thread. The scene, the images and the cache
/// must outlive it.
class ShapeResources {
 public:
  /// Segments of primitives, fine to coarse. Levels after kCoarsestPrimitive are for primitives of a few pixels.
  static constexpr std::array<int, 6> kSegments = {64, 32, 16, 8, 6, 4};
  static constexpr std::size_t kCoarsestPrimitive = 3;

  static constexpr std::size_t kCoarsestText = vrml::kTextBars;

  ShapeResources(const Images& images, MeshCache& meshes, std::shared_ptr<Budget> budget)
      : images_(images), meshes_(meshes), budget_(std::move(budget)) {}

  [[nodiscard]] Schemas& schemas() { return schemas_; }
  [[nodiscard]] const Images& images() const { return images_; }
  /// Nodes of an Appearance; each may be null.
  struct AppearanceNodes {
    const vrml::Node *appearance = nullptr, *material = nullptr, *texture = nullptr, *texture_transform = nullptr;
    bool material_textures = false;  // the material has textures (X3D 4)
    [[nodiscard]] bool textured() const { return texture || material_textures; }
    const vrml::Node *line = nullptr, *fill = nullptr, *point = nullptr;  // LineProperties and so on
    /// Reports whether meshes need texture coordinates: for a texture, or for the pattern of lines.
    [[nodiscard]] bool need_coordinates() const { return textured() || line; }
  };
  [[nodiscard]] AppearanceNodes appearance_nodes(const vrml::SceneGraph& scene, const NodeView& shape);
  /// Sets material and texture of an item from the Appearance of its Shape. `scale` is that of a shared default
  /// primitive. Generated texture coordinates depend on the item's mesh, if it is set.
  void apply_appearance(DrawItem& item, const vrml::SceneGraph& scene, const NodeView& shape,
                        const glm::vec3& scale = glm::vec3(1));
  /// Adjusts generated texture coordinates to the item's mesh. Call it after the mesh of a new item was set.
  void fit_layers(DrawItem& item, const glm::vec3& scale);
  /// Sets the faces of a TextureBackground.
  void add_faces(Background& background, const vrml::SceneGraph& scene, const NodeView& node);
  /// Returns the mesh of a geometry node, and makes it if necessary. If a worker thread makes it (MeshCache::late),
  /// returns the previous mesh. Null or an empty mesh means that nothing is drawn.
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> mesh_of(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                          bool textured);
  /// Mesh of a Text at `level` of vrml::kTextTolerances. The coarsest mesh if the budget does not permit that level.
  struct TextMesh {
    std::shared_ptr<const vrml::Mesh> mesh;
    std::uint8_t level;
  };
  [[nodiscard]] TextMesh text_mesh_of(const vrml::SceneGraph& scene, vrml::NodeId geometry, bool textured,
                                      std::size_t level);
  /// Returns the mesh of a geometry with triangles. If `pictured`, returns the part with a texture, otherwise the rest.
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> surface_mesh(const std::shared_ptr<const qnv::Geometry>& geometry,
                                                               bool pictured) {
    return meshes_.surface_of(geometry, pictured);
  }
  /// Returns the texture of a QNV node's surface (qnv::IndexedMesh::picture) from the images of nodes; empty until it
  /// has loaded.
  [[nodiscard]] TextureUse surface_texture(const vrml::Node& node, const qnv::IndexedMesh& mesh) const;
  /// Returns the shared mesh of a Box, Cone, Cylinder or Sphere with default sizes, and its coarser levels. `fineness`
  /// is an index in kSegments.
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> primitive(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                            std::size_t fineness);
  /// Reports whether a mesh was made after the last call.
  [[nodiscard]] bool clear_made_mesh() { return std::exchange(made_mesh_, false); }
  void report_limit(const std::string& why, const vrml::SceneGraph& scene, vrml::NodeId node);
  [[nodiscard]] std::vector<LimitReport>& limit_reports() { return limit_reports_; }
  /// Forgets the refining OutlineGroups. Call it when they may have changed.
  void forget_refiners() { refiners_.clear(); }

 private:
  /// Views of LineProperties, FillProperties and PointProperties of an Appearance; each may be empty.
  struct StyleNodes {
    NodeView line, fill, point;
  };
  [[nodiscard]] StyleNodes style_nodes(const vrml::SceneGraph& scene, vrml::NodeId appearance);
  [[nodiscard]] std::shared_ptr<const ShapeStyle> style_use(const vrml::SceneGraph& scene, vrml::NodeId appearance);
  TextureUse texture_use(const vrml::SceneGraph& scene, const vrml::ShapeParts& parts);
  friend class LayerBuilder;
  friend class VolumeLookBuilder;
  std::shared_ptr<const LayeredMaterial> keep(LayeredMaterial material);
  std::shared_ptr<const Image> volume_of_pixels(const vrml::SceneGraph& scene, vrml::NodeId texture);
  std::shared_ptr<const Image> volume_of_textures(const vrml::SceneGraph& scene, vrml::NodeId texture);
  std::shared_ptr<const SceneCube> scene_cube(const vrml::SceneGraph& scene, vrml::NodeId texture);
  std::shared_ptr<const Image> image_of_texture(const vrml::SceneGraph& scene, vrml::NodeId texture);
  vrml::NodeId refiner_of(const vrml::SceneGraph& scene, vrml::NodeId geometry);
  void bring_up_to_date(MeshCache::Entry& entry, const vrml::SceneGraph& scene, vrml::NodeId geometry, bool textured,
                        std::size_t text_level);
  void make_mesh(MeshCache::Entry& entry, const vrml::SceneGraph& scene, vrml::NodeId geometry,
                 const vrml::MeshOptions& options);

  const Images& images_;
  MeshCache& meshes_;
  std::shared_ptr<Budget> budget_;
  Schemas schemas_;
  // Refining OutlineGroup, by scene and node index of the refined OutlineGroup.
  std::unordered_map<const vrml::SceneGraph*, std::unordered_map<std::uint32_t, vrml::NodeId>> refiners_;
  std::vector<std::shared_ptr<const ShapeStyle>> styles_;  // the last distinct styles
  std::vector<LimitReport> limit_reports_;
  std::vector<std::weak_ptr<const LayeredMaterial>> layered_;  // the latest ones, which equal items share
  bool made_mesh_ = false;
};

/// Returns the level of detail of a text, an index in vrml::kTextTolerances, at which no corners of outlines are
/// visible. Depends on the font size at the nearest point of `bounds`, the text's box in world space.
/// `viewer` and `sight` are those of the picture. `pictures` permits the glyph atlas for small text.
[[nodiscard]] std::size_t text_level(const vrml::Mesh& text, const glm::dmat4& world_from_node, const WideBox& bounds,
                                     const glm::dvec3& viewer, const Sight& sight, bool pictures);

}  // namespace gs::render
