#pragma once

#include "render/collection/shapes/shape_resources.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace gs::render {

/// Translates the Appearance of one Shape to a LayeredMaterial (X3D Shape, Texturing, Texturing3D, CubeMapTexturing).
/// Nodes are those of one scene. One thread.
class LayerBuilder {
 public:
  LayerBuilder(ShapeResources& resources, const vrml::SceneGraph& scene, const vrml::ShapeParts& parts,
               vrml::NodeId geometry);

  /// Reports whether DrawItem::material and DrawItem::texture can express the Appearance.
  [[nodiscard]] bool is_plain() const;
  [[nodiscard]] LayeredMaterial build();

 private:
  /// Fields of a material with a texture and with the name of its mapping.
  struct Slot {
    std::string_view texture, mapping;
    TextureLayer::Target target;
  };
  [[nodiscard]] static std::span<const Slot> slots();
  void set_model();
  void set_back();
  void set_alpha_mode();
  void add_slots();
  void add_appearance_texture();
  void add_multi_texture(const NodeView& multi);
  bool set_texture(TextureLayer& layer, vrml::NodeId texture);
  bool set_cube_faces(TextureLayer& layer, const vrml::SceneGraph& scene, const NodeView& cube);
  void set_single_modes(TextureLayer& layer) const;
  void set_coordinates(TextureLayer& layer, std::size_t unit, std::string_view mapping) const;
  void set_generator(TextureLayer& layer, vrml::NodeId generator) const;
  void set_transform(TextureLayer& layer, std::size_t unit, std::string_view mapping) const;
  [[nodiscard]] glm::mat4 matrix_of(vrml::NodeId transform) const;
  void add(TextureLayer layer, std::size_t unit, std::string_view mapping);
  [[nodiscard]] std::vector<vrml::NodeId> transforms() const;
  [[nodiscard]] std::string_view text_in(vrml::NodeId node, std::string_view field) const;

  ShapeResources& resources_;
  const vrml::SceneGraph& scene_;
  vrml::NodeId appearance_, material_, texture_, transform_;
  NodeView material_view_, texture_view_;
  std::vector<vrml::NodeId> coordinates_;
  bool modern_ = false;    // X3D 4: textures modulate
  bool has_main_ = false;  // a texture of the material replaces that of the Appearance
  LayeredMaterial result_;
};

}  // namespace gs::render
