#pragma once

#include "render/gl/gpu.h"
#include "render/gl/light_tree.h"
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

/// Where kLightingShader of a program has its lights.
struct LightUniforms {
  GLint many = -1, first = -1;  // the buffer of all sets, and the texel at which the set begins; -1: a uniform block

  LightUniforms() = default;
  LightUniforms(const Gl& gl, GLuint program);
};

/// Chooses for every item the lights that reach it and keeps each distinct choice once in one
/// buffer, so that items with the same lights can be drawn together. Sets of up to kMaxOfBlock lights are read as
/// uniform blocks, larger ones as a buffer texture.
class LightSets {
 public:
  static constexpr std::size_t kMaxOfBlock = 64;
  static constexpr GLuint kBinding = 0;  // of the uniform block
  static constexpr GLuint kUnit = 7;     // of the buffer texture
  /// The variants of the lighting shader that take any number of lights of a uniform block, and of the buffer texture.
  static constexpr unsigned kLoop = 3, kMany = 4;

  /// The variant of the lighting shader for a number of lights.
  static unsigned variant(std::size_t count) {
    return count > kMaxOfBlock ? kMany : static_cast<unsigned>(std::min<std::size_t>(count, kLoop));
  }
  /// What kLightingShader wants to be defined for a variant.
  static std::string defines(unsigned variant);

  explicit LightSets(const Gl& gl);

  /// Forgets the choices of the last frame and takes all lights to camera space.
  void begin(const std::vector<Light>& lights, const glm::dmat4& camera_from_world, bool headlight);
  /// The number of the set for an item: its own directional lights, the headlight, and the point
  /// and spot lights whose radius reaches the sphere (camera space), the strongest ones if they are more than
  /// kMaxLightsOfAnItem. A negative radius means that the item's size is not known.
  std::uint32_t choose(const LightList& directional, const glm::vec3& center, float radius);
  /// The number of lights of a set.
  [[nodiscard]] std::size_t count(std::uint32_t set) const { return sets_[set].size(); }
  /// Whether a set has only directional lights, so that the light is the same everywhere.
  [[nodiscard]] bool directional_only(std::uint32_t set) const { return directional_only_[set]; }
  /// What the shader makes of a surface of one direction (camera space, unit, towards the viewer) without a specular
  /// colour in a set that has directional lights only: the colour of all its pixels, which may exceed 1.
  [[nodiscard]] glm::vec3 color_of(std::uint32_t set, const glm::vec3& normal, const glm::vec3& diffuse,
                                   const glm::vec3& emissive, float ambient_intensity) const;
  /// Sends all sets to the GPU. Between `choose` and `bind`.
  void upload();
  /// For the program in use.
  void bind(std::uint32_t set, const LightUniforms& uniforms);

 private:
  /// One light in the layout of the uniform block (std140).
  struct ShaderLight {
    glm::vec3 location;  // directional: towards the light
    float local;         // 0 directional, 1 point or spot
    glm::vec3 color;
    float intensity;
    glm::vec3 direction;
    float ambient_intensity;
    glm::vec3 attenuation;
    float radius;
    float cut_off_angle, fading;  // 1 / (cutOffAngle - beamWidth)
    float padding[2];
  };
  static_assert(sizeof(ShaderLight) == 80);
  struct ShaderSet {
    std::int32_t count;
    float number;  // the same, for who reads texels
    std::int32_t padding[2];
    ShaderLight lights[kMaxOfBlock];
  };
  static_assert(sizeof(ShaderSet) <= 16 * 1024);  // what OpenGL promises at least
  using Choice = std::vector<std::uint16_t>;      // indices into lights_
  struct ChoiceHash {
    std::size_t operator()(const Choice& choice) const;
  };

  static ShaderLight headlight();
  static ShaderLight directional_light(const glm::vec3& to_light);

  static constexpr std::uint16_t kHeadlight = 0xFFFF;

  /// Bytes of a set of so many lights in the buffer.
  [[nodiscard]] std::size_t stride(std::size_t count) const;
  void choose_local(const glm::vec3& center, float radius, std::size_t most);
  static ShaderLight to_camera(const Light& light, const glm::dmat4& camera_from_world);

  const Gl& gl_;
  Buffer buffer_;
  Texture texture_;                  // its texels
  std::size_t most_texels_ = 0;      // that a buffer texture may have
  std::vector<ShaderLight> lights_;  // camera space, in the order of the list
  std::vector<bool> directional_;
  LightTree local_, few_;      // point and spot lights; the strongest near the camera, where they are many
  std::size_t looked_at_ = 0;  // local lights, for all items of the frame
  bool headlight_ = true;
  std::unordered_map<Choice, std::uint32_t, ChoiceHash> numbers_;
  std::vector<Choice> sets_;
  std::vector<bool> directional_only_;  // by set
  std::vector<std::size_t> offsets_;    // in the buffer, by set
  std::size_t bytes_ = 0;               // of all sets
  Choice choice_, last_choice_;
  std::vector<std::pair<float, std::uint16_t>> reaching_;  // less than 0 is stronger
  std::uint32_t last_number_ = 0;
};

}  // namespace gs::render
