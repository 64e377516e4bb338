#pragma once

#include "render/image/image.h"

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace gs::render {

/// How a texture is sampled (X3D TextureProperties).
struct Sampling {
  enum class Edge : std::uint8_t { repeat, clamp, border, mirror };
  enum class Filter : std::uint8_t { linear_mipmap_linear, linear, nearest, nearest_mipmap_nearest };
  Edge s = Edge::repeat, t = Edge::repeat, r = Edge::repeat;
  Filter smaller = Filter::linear_mipmap_linear;  // minification
  bool smooth = true;                             // linear filter for magnification, otherwise the nearest pixel
  float anisotropy = 0;                           // maximum; 0 is the default of the renderer
  glm::vec4 border{0.0f};
  friend bool operator==(const Sampling&, const Sampling&) = default;
};

/// Picture of the scene around a point, which the renderer draws (X3D GeneratedCubeMapTexture). The renderer identifies
/// it by the address.
struct SceneCube {
  enum class Update : std::uint8_t { none, next_frame_only, always };
  int size = 128;  // pixels along the side of a face
  Update update = Update::none;
  std::uint64_t request = 0;  // changes when `update` is set
};

/// One texture of a LayeredMaterial.
struct TextureLayer {
  enum class Kind : std::uint8_t { image, volume, cube, scene_cube };
  /// Quantity that the texture changes. Stages apply to the main colour in order.
  enum class Target : std::uint8_t {
    stage,
    main,
    ambient,
    emissive,
    specular,
    shininess,
    normal,
    occlusion,
    metallic_roughness
  };
  /// Source of texture coordinates: the mesh, or a mode of TextureCoordinateGenerator.
  enum class Coordinates : std::uint8_t {
    mesh,
    box,  // position relative to the bounding box of the mesh
    sphere,
    camera_normal,
    camera_position,
    camera_reflection,
    world_normal,
    world_reflection,
    sphere_local,
    position,
    noise,
    noise_camera,
    refraction,
    refraction_local
  };
  /// Blending operation of a stage (X3D MultiTexture.mode), for the colour or for alpha.
  enum class Mode : std::uint8_t {
    modulate,
    replace,
    modulate_2x,
    modulate_4x,
    add,
    add_signed,
    add_signed_2x,
    subtract,
    add_smooth,
    blend_diffuse_alpha,
    blend_texture_alpha,
    blend_factor_alpha,
    blend_current_alpha,
    modulate_alpha_add_color,
    modulate_inverse_alpha_add_color,
    modulate_inverse_color_add_alpha,
    dot_product,
    select_1,
    select_2,
    off
  };
  enum class Source : std::uint8_t { previous, diffuse, specular, factor };
  enum class Function : std::uint8_t { none, complement, alpha_replicate };

  Kind kind = Kind::image;
  Target target = Target::stage;
  Coordinates coordinates = Coordinates::mesh;
  std::uint8_t set = 0;  // set of texture coordinates of the mesh
  Mode color_mode = Mode::modulate, alpha_mode = Mode::modulate;
  Source source = Source::previous;
  Function function = Function::none;
  std::shared_ptr<const Image> image;                 // of an image, a volume (Image::slices) or a cube (Image::cube)
  std::array<std::shared_ptr<const Image>, 6> faces;  // of a cube, in the order of Background::Face
  std::shared_ptr<const SceneCube> scene_cube;
  Sampling sampling;
  glm::mat4 transform{1.0f};          // from texture coordinates of the source to texture space
  std::array<float, 6> parameters{};  // of the generator
  friend bool operator==(const TextureLayer&, const TextureLayer&) = default;
};

/// Colours of the back faces (X3D TwoSidedMaterial, Appearance.backMaterial).
struct BackMaterial {
  glm::vec3 main{0.8f}, emissive{0.0f}, specular{0.0f};  // `main`: diffuse, base or unlit colour; of a display
  float ambient_intensity = 0.2f, shininess = 0.2f, transparency = 0;
  float metallic = 1, roughness = 1;
  friend bool operator==(const BackMaterial&, const BackMaterial&) = default;
};

/// Appearance that Material and one texture cannot express: several textures, generated texture coordinates, physical
/// lighting, back colours, alpha modes. The colours of the front are in DrawItem::material. Shared by equal items.
struct LayeredMaterial {
  enum class Model : std::uint8_t { unlit, phong, physical };
  enum class AlphaMode : std::uint8_t { automatic, opaque, mask, blend };
  Model model = Model::phong;
  AlphaMode alpha_mode = AlphaMode::automatic;
  float alpha_cutoff = 0.5f;
  bool has_back = false;
  BackMaterial back;
  float metallic = 1, roughness = 1;
  float normal_scale = 1, occlusion_strength = 1;
  glm::vec4 factor{1.0f};            // color and alpha of a MultiTexture
  std::vector<TextureLayer> layers;  // at most kMaxTextureLayers
  friend bool operator==(const LayeredMaterial&, const LayeredMaterial&) = default;
};
inline constexpr std::size_t kMaxTextureLayers = 12;

/// Exponent between linear colours and colours of a display, as in the shader of physical materials.
inline constexpr float kDisplayGamma = 2.2f;
/// Converts a linear colour of a physical material to a colour of a display, and back.
[[nodiscard]] inline glm::vec3 displayed(const glm::vec3& linear) {
  return glm::pow(glm::max(linear, glm::vec3(0)), glm::vec3(1 / kDisplayGamma));
}
[[nodiscard]] inline glm::vec3 linear_of_display(const glm::vec3& color) {
  return glm::pow(glm::max(color, glm::vec3(0)), glm::vec3(kDisplayGamma));
}

}  // namespace gs::render
