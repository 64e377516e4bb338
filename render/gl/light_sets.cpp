#include "render/gl/light_sets.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kMaxSets = 60'000;
// After kManyLooks light tests in a frame, further items consider only the kFewLocal strongest lights near the camera.
constexpr std::size_t kManyLooks = 4'000'000, kFewLocal = 256;
// If the sets of a frame exceed kManyBytes, further sets have at most kFewLights lights.
constexpr std::size_t kManyBytes = std::size_t{32} << 20, kFewLights = 16;

constexpr std::size_t kTexel = 16;  // bytes of a texel

constexpr float kEverywhere = 4;  // cut-off angle in radians that includes all directions
constexpr float kAtOnce = 1e30f;  // factor for a spot light with a hard edge

float attenuation_at(const glm::vec3& coefficients, float distance) {
  return 1.0f / std::max(coefficients.x + coefficients.y * distance + coefficients.z * distance * distance, 1.0f);
}

}  // namespace

std::size_t LightSets::ChoiceHash::operator()(const Choice& choice) const {
  std::size_t hash = 14695981039346656037u;  // FNV-1a hash
  for (const std::uint16_t index : choice) hash = (hash ^ index) * 1099511628211u;
  return hash;
}

LightUniforms::LightUniforms(const Gl& gl, GLuint program)
    : many(gl.GetUniformLocation(program, "many_lights")), first(gl.GetUniformLocation(program, "first_light")) {
  const GLuint block = gl.GetUniformBlockIndex(program, "Lights");
  if (block != GL_INVALID_INDEX) gl.UniformBlockBinding(program, block, LightSets::kBinding);
}

LightSets::LightSets(const Gl& gl) : gl_(gl), buffer_(make_buffer(gl)), texture_(make_texture(gl)) {
  GLint texels = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  most_texels_ = static_cast<std::size_t>(std::max(texels, 0));
}

std::string LightSets::defines(unsigned variant) {
  if (variant == kMany) return "#define MANY_LIGHTS\n";
  std::string text = "#define MOST_LIGHTS " + std::to_string(kMaxOfBlock) + "\n";
  if (variant == kLoop) return text;
  text += "#define ALL_LIGHTS";
  for (unsigned i = 0; i < variant; ++i) text += " ADD(" + std::to_string(i) + ")";
  return text + "\n";
}

std::size_t LightSets::stride(std::size_t count) const {
  const auto alignment = static_cast<std::size_t>(gl_.uniform_offset_alignment);
  return (offsetof(ShaderSet, lights) + count * sizeof(ShaderLight) + alignment - 1) / alignment * alignment;
}

/// Returns a directional light for the shader. Its terms for local lights are neutral.
LightSets::ShaderLight LightSets::directional_light(const glm::vec3& to_light) {
  ShaderLight result{};
  result.location = to_light;
  result.attenuation = {1, 0, 0};
  result.radius = std::numeric_limits<float>::max();
  result.cut_off_angle = kEverywhere;
  result.fading = kAtOnce;
  return result;
}

LightSets::ShaderLight LightSets::to_camera(const Light& light, const glm::dmat4& camera_from_world) {
  const glm::vec3 direction(glm::dmat3(camera_from_world) * glm::dvec3(light.direction));
  ShaderLight result = directional_light(-direction);
  result.color = light.color;
  result.intensity = light.intensity;
  result.direction = direction;
  result.ambient_intensity = light.ambient_intensity;
  if (light.kind == Light::Kind::directional) return result;
  result.location = glm::vec3(camera_from_world * glm::dvec4(light.location, 1));
  result.local = 1;
  result.attenuation = light.attenuation;
  result.radius = light.radius;
  if (light.kind == Light::Kind::point) return result;
  result.cut_off_angle = light.cut_off_angle;
  const float width = light.cut_off_angle - light.beam_width;
  if (width > 1 / kAtOnce) result.fading = 1 / width;
  return result;
}

void LightSets::begin(const std::vector<Light>& lights, const glm::dmat4& camera_from_world,
                      const DrawOptions& options) {
  lights_.clear();
  directional_.clear();
  listed_.clear();
  global_.clear();
  numbers_.clear();
  sets_.clear();
  directional_only_.assign(1, true);
  offsets_.assign(1, 0);
  bytes_ = stride(0);
  headlight_ = options.headlight;
  headlight_towards_ = options.headlight_towards;
  std::vector<LightTree::Sphere> local;
  const std::size_t count = std::min<std::size_t>(lights.size(), kHeadlight);
  for (std::size_t i = 0; i < count; ++i) {
    lights_.push_back(to_camera(lights[i], camera_from_world));
    directional_.push_back(lights[i].kind == Light::Kind::directional);
    listed_.push_back(lights[i].listed());
    if (listed_.back()) continue;
    if (directional_.back())
      global_.push_back(static_cast<std::uint16_t>(i));
    else
      local.push_back({lights_.back().location, lights_.back().radius, static_cast<std::uint16_t>(i)});
  }
  local_.build(local);
  if (local.size() > kFewLocal) {
    const auto strength = [&](const LightTree::Sphere& sphere) {
      return lights_[sphere.number].intensity / (1.0f + std::max(glm::length(sphere.center) - sphere.radius, 0.0f));
    };
    std::nth_element(local.begin(), local.begin() + kFewLocal, local.end(),
                     [&](const auto& a, const auto& b) { return strength(a) > strength(b); });
    local.resize(kFewLocal);
  }
  few_.build(std::move(local));
  looked_at_ = 0;
  last_choice_.clear();  // set 0 is empty
  last_number_ = 0;
  numbers_.emplace(last_choice_, 0);
  sets_.push_back(last_choice_);
}

// Appends the strongest local lights to choice_, in file order, until it has `most` lights.
void LightSets::choose_local(const glm::vec3& center, float radius, std::size_t most) {
  reaching_.clear();
  (looked_at_ < kManyLooks ? local_ : few_).each_near(center, radius, [&](const LightTree::Sphere& sphere) {
    const ShaderLight& light = lights_[sphere.number];
    const float distance = glm::length(light.location - center);
    // A light that reaches only a part of the item has a smaller weight.
    const float covered = radius > 0 ? std::min((light.radius + radius - distance) / (2 * radius), 1.0f) : 1.0f;
    const float strength = covered * light.intensity * std::max({light.color.r, light.color.g, light.color.b}) *
                           attenuation_at(light.attenuation, std::max(distance - std::max(radius, 0.0f), 0.0f));
    reaching_.emplace_back(-strength / (1.0f + distance), sphere.number);
  });
  looked_at_ += reaching_.size();
  if (const std::size_t room = most - choice_.size(); reaching_.size() > room) {
    std::nth_element(reaching_.begin(), reaching_.begin() + static_cast<std::ptrdiff_t>(room), reaching_.end());
    reaching_.resize(room);
  }
  const auto first = static_cast<std::ptrdiff_t>(choice_.size());
  for (const auto& [strength, index] : reaching_) choice_.push_back(index);
  std::sort(choice_.begin() + first, choice_.end());
}

std::uint32_t LightSets::choose(const LightList& directional, const glm::vec3& center, float radius) {
  std::size_t most = kMaxLightsOfAnItem;
  if ((bytes_ + stride(most)) / kTexel > most_texels_) most = kMaxOfBlock;
  if (bytes_ >= kManyBytes) most = kFewLights;
  choice_.clear();
  if (headlight_) choice_.push_back(kHeadlight);
  for (const std::uint16_t index : global_)
    if (choice_.size() < most) choice_.push_back(index);
  for (const std::uint16_t index : directional)
    if (choice_.size() < most && index < lights_.size() && listed_[index]) choice_.push_back(index);
  if (!local_.empty() && choice_.size() < most) choose_local(center, radius, most);
  if (choice_ == last_choice_) return last_number_;
  if (sets_.size() >= kMaxSets) return 0;
  const auto [found, fresh] = numbers_.emplace(choice_, static_cast<std::uint32_t>(sets_.size()));
  if (fresh) {
    sets_.push_back(choice_);
    offsets_.push_back(bytes_);
    bytes_ += stride(choice_.size());
    directional_only_.push_back(std::all_of(choice_.begin(), choice_.end(), [&](std::uint16_t index) {
      return index == kHeadlight || directional_[index];
    }));
  }
  std::swap(last_choice_, choice_);
  last_number_ = found->second;
  return last_number_;
}

/// Returns the headlight of VRML97 6.29: white, intensity 1, ambientIntensity 0, along the view unless the options
/// choose another direction.
LightSets::ShaderLight LightSets::headlight() const {
  ShaderLight result = directional_light(headlight_towards_);
  result.color = glm::vec3(1);
  result.intensity = 1;
  return result;
}

glm::vec3 LightSets::color_of(std::uint32_t set, const glm::vec3& normal, const glm::vec3& diffuse,
                              const glm::vec3& emissive, float ambient_intensity) const {
  glm::vec3 sum = emissive;
  for (const std::uint16_t index : sets_[set]) {
    const ShaderLight light = index == kHeadlight ? headlight() : lights_[index];
    sum += light.color * (light.ambient_intensity * ambient_intensity * diffuse +
                          light.intensity * std::max(glm::dot(normal, light.location), 0.0f) * diffuse);
  }
  return sum;
}

void LightSets::upload() {
  const PhaseScope phase(gl_.phases, Phase::upload);
  const ShaderLight ahead = headlight();
  // Add room after the last set, because a complete uniform block is bound there.
  std::vector<std::byte> bytes(bytes_ + sizeof(ShaderSet));
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    std::byte* const to = bytes.data() + offsets_[i];
    const auto count = static_cast<std::int32_t>(sets_[i].size());
    const auto number = static_cast<float>(count);
    std::memcpy(to, &count, sizeof count);
    std::memcpy(to + offsetof(ShaderSet, number), &number, sizeof number);
    for (std::size_t k = 0; k < sets_[i].size(); ++k) {
      const std::uint16_t index = sets_[i][k];
      const ShaderLight& light = index == kHeadlight ? ahead : lights_[index];
      std::memcpy(to + offsetof(ShaderSet, lights) + k * sizeof light, &light, sizeof light);
    }
  }
  gl_.BindBuffer(GL_UNIFORM_BUFFER, buffer_.name());
  gl_.BufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STREAM_DRAW);
}

void LightSets::bind(std::uint32_t set, const LightUniforms& uniforms) {
  const std::size_t count = sets_[set].size();
  if (uniforms.many >= 0) {
    gl_.ActiveTexture(GL_TEXTURE0 + kUnit);
    gl_.BindSampler(kUnit, 0);
    gl_.BindTexture(GL_TEXTURE_BUFFER, texture_.name());
    gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, buffer_.name());
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.Uniform1i(uniforms.many, kUnit);
    gl_.Uniform1i(uniforms.first, static_cast<GLint>(offsets_[set] / kTexel));
    return;
  }
  // OpenGL requires a binding of the complete block. Mesa's software drivers copy the bound range on each use, and
  // accept a range without the unused part.
  const std::size_t size = gl_.software ? stride(count) : sizeof(ShaderSet);
  gl_.BindBufferRange(GL_UNIFORM_BUFFER, kBinding, buffer_.name(), static_cast<GLintptr>(offsets_[set]),
                      static_cast<GLsizeiptr>(size));
}

}  // namespace gs::render
