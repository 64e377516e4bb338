#include "render/gl/light_sets.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cstring>
#include <utility>

namespace gs::render {
namespace {

// Point and spot lights that are looked at for an item; the strongest near the camera if there are more.
constexpr std::size_t kMaxLocalLights = 256;
constexpr std::size_t kMaxSets = 60'000;

float attenuation_at(const glm::vec3& coefficients, float distance) {
  return 1.0f / std::max(coefficients.x + coefficients.y * distance + coefficients.z * distance * distance, 1.0f);
}

}  // namespace

std::size_t LightSets::ChoiceHash::operator()(const Choice& choice) const {
  std::size_t hash = 14695981039346656037u;  // FNV-1a
  for (std::size_t i = 0; i <= choice[0]; ++i) hash = (hash ^ choice[i]) * 1099511628211u;
  return hash;
}

LightSets::LightSets(const Gl& gl) : gl_(gl), buffer_(make_buffer(gl)) {
  const auto alignment = static_cast<std::size_t>(gl.uniform_offset_alignment);
  stride_ = (sizeof(ShaderSet) + alignment - 1) / alignment * alignment;
}

LightSets::ShaderLight LightSets::to_camera(const Light& light, const glm::dmat4& camera_from_world) {
  ShaderLight result{};
  const glm::vec3 direction(glm::dmat3(camera_from_world) * glm::dvec3(light.direction));
  const bool directional = light.kind == Light::Kind::directional;
  result.location = directional ? -direction : glm::vec3(camera_from_world * glm::dvec4(light.location, 1));
  result.kind = directional ? 0.0f : light.kind == Light::Kind::point ? 1.0f : 2.0f;
  result.color = light.color;
  result.intensity = light.intensity;
  result.direction = direction;
  result.ambient_intensity = light.ambient_intensity;
  result.attenuation = light.attenuation;
  result.radius = light.radius;
  result.beam_width = light.beam_width;
  result.cut_off_angle = light.cut_off_angle;
  return result;
}

void LightSets::begin(const std::vector<Light>& lights, const glm::dmat4& camera_from_world, bool headlight) {
  lights_.clear();
  directional_.clear();
  local_.clear();
  numbers_.clear();
  sets_.clear();
  directional_only_.assign(1, true);
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

void LightSets::choose_local(const glm::vec3& center, float radius, Choice& choice) {
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
  const std::size_t room = kMaxLights - choice[0];
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
  if (headlight_) choice[++choice[0]] = kHeadlight;
  for (const std::uint16_t index : directional)
    if (choice[0] < kMaxLights && index < lights_.size() && directional_[index]) choice[++choice[0]] = index;
  if (!local_.empty() && choice[0] < kMaxLights) choose_local(center, radius, choice);
  if (choice == last_choice_) return last_number_;
  if (sets_.size() >= kMaxSets) return 0;
  const auto [found, fresh] = numbers_.emplace(choice, static_cast<std::uint32_t>(sets_.size()));
  if (fresh) {
    sets_.push_back(choice);
    directional_only_.push_back(
        std::all_of(choice.begin() + 1, choice.begin() + 1 + choice[0],
                    [&](std::uint16_t index) { return index == kHeadlight || directional_[index]; }));
  }
  last_choice_ = choice;
  last_number_ = found->second;
  return last_number_;
}

void LightSets::upload() {
  ShaderLight headlight{};  // VRML97 6.29: white, intensity 1, ambientIntensity 0, along the view
  headlight.location = {0, 0, 1};
  headlight.color = glm::vec3(1);
  headlight.intensity = 1;
  std::vector<std::byte> bytes(sets_.size() * stride_);
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    ShaderSet set{};
    for (std::size_t k = 0; k < sets_[i][0]; ++k) {
      const std::uint16_t index = sets_[i][k + 1];
      set.lights[k] = index == kHeadlight ? headlight : lights_[index];
    }
    std::memcpy(bytes.data() + i * stride_, &set, sizeof set);
  }
  gl_.BindBuffer(GL_UNIFORM_BUFFER, buffer_.name());
  gl_.BufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STREAM_DRAW);
}

void LightSets::bind(std::uint32_t set) {
  gl_.BindBufferRange(GL_UNIFORM_BUFFER, kBinding, buffer_.name(), static_cast<GLintptr>(set * stride_),
                      sizeof(ShaderSet));
}

}  // namespace gs::render
