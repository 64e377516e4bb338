#pragma once

#include "app/formats/common/scene_builder.h"
#include "app/formats/gltf/gltf_accessor.h"

#include <tiny_gltf.h>

#include <glm/vec2.hpp>

#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace gs::app {

/// Converts a number from the file to a finite float.
[[nodiscard]] float finite_float(double value);

/// KHR_texture_transform, in glTF texture space (origin at the top left).
struct GltfTextureTransform {
  glm::vec2 offset{0.0f}, scale{1.0f};
  float rotation = 0;
  [[nodiscard]] glm::vec2 apply(glm::vec2 uv) const;
  friend bool operator==(const GltfTextureTransform&, const GltfTextureTransform&) = default;
};

/// Texture of a material, and the coordinates that it uses. `texture` is negative if there is none.
struct GltfMap {
  int texture = -1;
  int set = 0;  // n of TEXCOORD_n
  std::optional<GltfTextureTransform> transform;
};

/// Properties of a material that a primitive needs.
struct GltfSurface {
  int texture_set = 0;  // n of TEXCOORD_n
  std::optional<GltfTextureTransform> transform;
  bool textured = false;
  bool has_base = false;  // one of its textures has the colours
  bool double_sided = false;
  glm::vec3 factor{1.0f};  // linear colour; multiplies vertex colours
};

/// Materials of an asset, converted to VRML97 (6.27), or to the physical materials of X3D (12.4.6) if the scene is one
/// of X3D. Each Material is created once and shared by its Shapes.
class GltfMaterials {
 public:
  GltfMaterials(const tinygltf::Model& model, GltfAccessors& accessors, SceneBuilder& builder)
      : model_(model), accessors_(accessors), builder_(builder) {}

  /// Returns the surface of a material. An invalid index, such as -1, means the default material (glTF 2.0 3.9).
  [[nodiscard]] GltfSurface surface(int material) const;
  /// Returns an Appearance node. `glows` uses the colour as the emissive colour, for lines and points (VRML97 4.14.2).
  [[nodiscard]] vrml::NodeId appearance(int material, bool glows);

 private:
  [[nodiscard]] const tinygltf::Material* find(int material) const;
  [[nodiscard]] Look look(const tinygltf::Material& material, bool glows);
  [[nodiscard]] bool is_physical(const tinygltf::Material& material) const;
  [[nodiscard]] vrml::NodeId physical(const tinygltf::Material& material);
  void add_map(vrml::NodeId material, std::string_view field, const GltfMap& map, const GltfMap& first);
  void add_texture(int texture, Look& look);
  [[nodiscard]] vrml::String image_url(int image);

  const tinygltf::Model& model_;
  GltfAccessors& accessors_;
  SceneBuilder& builder_;
  std::map<std::pair<int, bool>, vrml::NodeId> appearances_;
  std::map<int, vrml::String> urls_;
};

}  // namespace gs::app
