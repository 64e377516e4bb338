#include "render/gl/light_sets.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

namespace gs::render {
namespace {

// Point and spot lights that are looked at for an item; the strongest near the camera if there are more.
constexpr std::size_t kMaxLocalLights = 256;
constexpr std::size_t kMaxSets = 60'000;
// When the sets of a frame are larger than this, further ones have fewer lights.
constexpr std::size_t kManyBytes = std::size_t{32} << 20, kFewLights = 16;

constexpr float kEverywhere = 4;  // radians: no angle is as large
constexpr float kAtOnce = 1e30f;  // how fast light fades at an edge that is not soft

float attenuation_at(const glm::vec3& coefficients, float distance) {
  return 1.0f / std::max(coefficients.x + coefficients.y * distance + coefficients.z * distance * distance, 1.0f);
}

}  // namespace

std::size_t LightSets::ChoiceHash::operator()(const Choice& choice) const {
  std::size_t hash = 14695981039346656037u;  // FNV-1a
  for (std::size_t i = 0; i <= choice[0]; ++i) hash = (hash ^ choice[i]) * 1099511628211u;
  return hash;
}

LightSets::LightSets(const Gl& gl) : gl_(gl), buffer_(make_buffer(gl)) {}

std::string LightSets::defines(unsigned variant) {
  std::string text = "#define MOST_LIGHTS " + std::to_string(kMaxLights) + "\n";
  if (variant == kLoop) return text;
  text += "#define ALL_LIGHTS";
  for (unsigned i = 0; i < variant; ++i) text += " ADD(" + std::to_string(i) + ")";
  return text + "\n";
}

std::size_t LightSets::stride(std::size_t count) const {
  const auto alignment = static_cast<std::size_t>(gl_.uniform_offset_alignment);
  return (offsetof(ShaderSet, lights) + count * sizeof(ShaderLight) + alignment - 1) / alignment * alignment;
}

/// Seen from everywhere alike: what the shader does with local lights leaves it as it is.
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

void LightSets::begin(const std::vector<Light>& lights, const glm::dmat4& camera_from_world, bool headlight) {
  lights_.clear();
  directional_.clear();
  local_.clear();
  numbers_.clear();
  sets_.clear();
  directional_only_.assign(1, true);
  offsets_.assign(1, 0);
  bytes_ = stride(0);
  headlight_ = headlight;
  const std::size_t count = std::min<std::size_t>(lights.size(), kHeadlight);
  for (std::size_t i = 0; i < count; ++i) {
    lights_.push_back(to_camera(lights[i], camera_from_world));
    directional_.push_back(lights[i].kind == Light::Kind::directional);
    if (!directional_.back()) local_.push_back(static_cast<std::uint16_t>(i));
  }
  if (local_.size() > kMaxLocalLights) {
    const auto strength = [&](std::uint16_t index) {
      const ShaderLight& light = lights_[index];
      const float distance = std::max(glm::length(light.location) - light.radius, 0.0f);
      return light.intensity / (1.0f + distance);
    };
    std::stable_sort(local_.begin(), local_.end(), [&](auto a, auto b) { return strength(a) > strength(b); });
    local_.resize(kMaxLocalLights);
    std::sort(local_.begin(), local_.end());
  }
  last_choice_ = {};  // the empty set is number 0
  last_number_ = 0;
  numbers_.emplace(last_choice_, 0);
  sets_.push_back(last_choice_);
}

void LightSets::choose_local(const glm::vec3& center, float radius, std::size_t most, Choice& choice) {
  std::array<std::pair<float, std::uint16_t>, kMaxLocalLights> reaching;
  std::size_t count = 0;
  for (const std::uint16_t index : local_) {
    const ShaderLight& light = lights_[index];
    const float distance = glm::length(light.location - center);
    if (radius >= 0 && distance > light.radius + radius) continue;
    // A light that ends before most of the item counts for less.
    const float covered = radius > 0 ? std::min((light.radius + radius - distance) / (2 * radius), 1.0f) : 1.0f;
    const float strength = covered * light.intensity * std::max({light.color.r, light.color.g, light.color.b}) *
                           attenuation_at(light.attenuation, std::max(distance - std::max(radius, 0.0f), 0.0f));
    reaching[count++] = {-strength / (1.0f + distance), index};
  }
  const std::size_t room = most - choice[0];
  if (count > room) {
    std::nth_element(reaching.begin(), reaching.begin() + static_cast<std::ptrdiff_t>(room),
                     reaching.begin() + static_cast<std::ptrdiff_t>(count));
    count = room;
    std::sort(reaching.begin(), reaching.begin() + static_cast<std::ptrdiff_t>(count),
              [](const auto& a, const auto& b) { return a.second < b.second; });
  }
  for (std::size_t i = 0; i < count; ++i) choice[++choice[0]] = reaching[i].second;
}

std::uint32_t LightSets::choose(const std::vector<std::uint16_t>& directional, const glm::vec3& center, float radius) {
  Choice choice{};
  const std::size_t most = bytes_ < kManyBytes ? kMaxLights : kFewLights;
  if (headlight_) choice[++choice[0]] = kHeadlight;
  for (const std::uint16_t index : directional)
    if (choice[0] < most && index < lights_.size() && directional_[index]) choice[++choice[0]] = index;
  if (!local_.empty() && choice[0] < most) choose_local(center, radius, most, choice);
  if (choice == last_choice_) return last_number_;
  if (sets_.size() >= kMaxSets) return 0;
  const auto [found, fresh] = numbers_.emplace(choice, static_cast<std::uint32_t>(sets_.size()));
  if (fresh) {
    sets_.push_back(choice);
    offsets_.push_back(bytes_);
    bytes_ += stride(choice[0]);
    directional_only_.push_back(
        std::all_of(choice.begin() + 1, choice.begin() + 1 + choice[0],
                    [&](std::uint16_t index) { return index == kHeadlight || directional_[index]; }));
  }
  last_choice_ = choice;
  last_number_ = found->second;
  return last_number_;
}

/// VRML97 6.29: white, intensity 1, ambientIntensity 0, along the view.
LightSets::ShaderLight LightSets::headlight() {
  ShaderLight result = directional_light({0, 0, 1});
  result.color = glm::vec3(1);
  result.intensity = 1;
  return result;
}

glm::vec3 LightSets::color_of(std::uint32_t set, const glm::vec3& normal, const glm::vec3& diffuse,
                              const glm::vec3& emissive, float ambient_intensity) const {
  glm::vec3 sum = emissive;
  const Choice& choice = sets_[set];
  for (std::size_t k = 0; k < choice[0]; ++k) {
    const ShaderLight light = choice[k + 1] == kHeadlight ? headlight() : lights_[choice[k + 1]];
    sum += light.color * (light.ambient_intensity * ambient_intensity * diffuse +
                          light.intensity * std::max(glm::dot(normal, light.location), 0.0f) * diffuse);
  }
  return sum;
}

void LightSets::upload() {
  const PhaseScope phase(gl_.phases, Phase::upload);
  const ShaderLight ahead = headlight();
  // Behind the last set as much as a whole uniform block may be bound.
  std::vector<std::byte> bytes(bytes_ + sizeof(ShaderSet));
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    std::byte* const to = bytes.data() + offsets_[i];
    const std::int32_t count = sets_[i][0];
    std::memcpy(to, &count, sizeof count);
    for (std::size_t k = 0; k < sets_[i][0]; ++k) {
      const std::uint16_t index = sets_[i][k + 1];
      const ShaderLight& light = index == kHeadlight ? ahead : lights_[index];
      std::memcpy(to + offsetof(ShaderSet, lights) + k * sizeof light, &light, sizeof light);
    }
  }
  gl_.BindBuffer(GL_UNIFORM_BUFFER, buffer_.name());
  gl_.BufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STREAM_DRAW);
}

void LightSets::bind(std::uint32_t set) {
  // OpenGL wants the whole block to be bound. Mesa's software drivers copy what is bound each time, and they do without
  // what the shader never reads.
  const std::size_t size = gl_.software ? stride(sets_[set][0]) : sizeof(ShaderSet);
  gl_.BindBufferRange(GL_UNIFORM_BUFFER, kBinding, buffer_.name(), static_cast<GLintptr>(offsets_[set]),
                      static_cast<GLsizeiptr>(size));
}

}  // namespace gs::render
