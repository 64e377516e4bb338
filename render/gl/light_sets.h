#pragma once

#include "render/gl/gpu.h"
#include "render/gl/light_tree.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::render {

/// Locations of the light data of kLightingShader in a program.
struct LightUniforms {
  GLint many = -1, first = -1;  // buffer texture, and first texel of the set; -1 means that a uniform block is used

  LightUniforms() = default;
  LightUniforms(const Gl& gl, GLuint program);
};

/// Selects the lights that reach each item. Stores each distinct set only once in a buffer, so that items with equal
/// lights can be drawn together. Shaders read sets of up to kMaxOfBlock lights as uniform blocks, larger sets as a
/// buffer texture.
class LightSets {
 public:
  static constexpr std::size_t kMaxOfBlock = 64;
  static constexpr GLuint kBinding = 0;  // binding of the uniform block
  static constexpr GLuint kUnit = 7;     // texture unit of the buffer texture
  /// Variants of the lighting shader for any number of lights: kLoop reads a uniform block, kMany the buffer texture.
  static constexpr unsigned kLoop = 3, kMany = 4;

  /// Returns the variant of kLightingShader for a number of lights.
  static unsigned variant(std::size_t count) {
    return count > kMaxOfBlock ? kMany : static_cast<unsigned>(std::min<std::size_t>(count, kLoop));
  }
  /// Returns the defines of kLightingShader for a variant.
  static std::string defines(unsigned variant);

  explicit LightSets(const Gl& gl);

  /// Clears the sets of the previous frame. Transforms all lights to camera space.
  void begin(const std::vector<Light>& lights, const glm::dmat4& camera_from_world, const DrawOptions& options);
  /// Returns the index of the light set for an item. The set has the item's directional lights, the headlight, and the
  /// point and spot lights that reach the sphere (camera space), up to kMaxLightsOfAnItem, strongest first. A negative
  /// radius means that the size is unknown.
  std::uint32_t choose(const LightList& directional, const glm::vec3& center, float radius);
  /// Returns the number of lights of a set.
  [[nodiscard]] std::size_t count(std::uint32_t set) const { return sets_[set].size(); }
  /// Reports whether a set has only directional lights. Lighting then does not depend on the position.
  [[nodiscard]] bool directional_only(std::uint32_t set) const { return directional_only_[set]; }
  /// Computes the colour that the shader gives a flat surface without specular colour. The set must have only
  /// directional lights. `normal` is a unit vector in camera space, towards the viewer. Components may exceed 1.
  [[nodiscard]] glm::vec3 color_of(std::uint32_t set, const glm::vec3& normal, const glm::vec3& diffuse,
                                   const glm::vec3& emissive, float ambient_intensity) const;
  /// Uploads all sets. Call it after all calls of `choose` and before `bind`.
  void upload();
  /// Binds a set for the current program.
  void bind(std::uint32_t set, const LightUniforms& uniforms);

 private:
  /// Light in the std140 layout of the uniform block.
  struct ShaderLight {
    glm::vec3 location;  // position, or direction towards a directional light
    float local;         // 0 for directional lights, 1 for point and spot lights
    glm::vec3 color;
    float intensity;
    glm::vec3 direction;
    float ambient_intensity;
    glm::vec3 attenuation;
    float radius;
    float cut_off_angle, fading;  // `fading`: 1 / (cutOffAngle - beamWidth)
    float padding[2];
  };
  static_assert(sizeof(ShaderLight) == 80);
  struct ShaderSet {
    std::int32_t count;
    float number;  // count as float, for the buffer texture
    std::int32_t padding[2];
    ShaderLight lights[kMaxOfBlock];
  };
  static_assert(sizeof(ShaderSet) <= 16 * 1024);  // 16 KiB is the minimum that OpenGL guarantees
  using Choice = std::vector<std::uint16_t>;      // indices in lights_
  struct ChoiceHash {
    std::size_t operator()(const Choice& choice) const;
  };

  [[nodiscard]] ShaderLight headlight() const;
  static ShaderLight directional_light(const glm::vec3& to_light);

  static constexpr std::uint16_t kHeadlight = 0xFFFF;

  /// Returns the bytes of a set of `count` lights in the buffer, with padding.
  [[nodiscard]] std::size_t stride(std::size_t count) const;
  void choose_local(const glm::vec3& center, float radius, std::size_t most);
  static ShaderLight to_camera(const Light& light, const glm::dmat4& camera_from_world);

  const Gl& gl_;
  Buffer buffer_;
  Texture texture_;                  // buffer texture of buffer_
  std::size_t most_texels_ = 0;      // maximum texels of a buffer texture
  std::vector<ShaderLight> lights_;  // in camera space, in the order of the list
  std::vector<bool> directional_, listed_;
  Choice global_;  // directional lights that reach all items
  LightTree local_,
      few_;  // point and spot lights that need not be listed; if there are many, few_ has the strongest near the camera
  std::size_t looked_at_ = 0;  // light tests for all items of the frame so far
  bool headlight_ = true;
  glm::vec3 headlight_towards_{0, 0, 1};
  std::unordered_map<Choice, std::uint32_t, ChoiceHash> numbers_;
  std::vector<Choice> sets_;
  std::vector<bool> directional_only_;  // by set
  std::vector<std::size_t> offsets_;    // byte offset in the buffer, by set
  std::size_t bytes_ = 0;               // bytes of all sets
  Choice choice_, last_choice_;
  std::vector<std::pair<float, std::uint16_t>> reaching_;  // negative strength and index of a light, strongest first
  std::uint32_t last_number_ = 0;
};

}  // namespace gs::render
