#include "render/mesh/filled_spheres.h"

#include <algorithm>
#include <bit>

namespace gs::render {
namespace {

constexpr std::uint32_t kMaxLayers = 8;
constexpr std::size_t kMaxBuckets = std::size_t{1} << 22;

/// Returns a hash of a sphere. All bits of the sphere influence its upper bits.
std::uint64_t hash_of(const glm::vec3& center, float radius) {
  const auto bits = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value)}; };
  const std::uint64_t place = bits(center.x) * 0x9E3779B97F4A7C15u ^ bits(center.y) << 32 ^ bits(center.z);
  return (place * 0xC2B2AE3D27D4EB4Fu ^ bits(radius)) * 0x9E3779B97F4A7C15u;
}

}  // namespace

void FilledSpheres::begin(std::size_t count) {
  spheres_.clear();
  buckets_.assign(std::bit_ceil(std::clamp<std::size_t>(count, 1, kMaxBuckets)), 0);
}

std::uint32_t FilledSpheres::layer_of(const glm::vec3& center, float radius, const State& state) {
  std::uint32_t& first = buckets_[(hash_of(center, radius) >> 32) & (buckets_.size() - 1)];
  const auto equal = [&](const Sphere& other) { return other.center == center && other.radius == radius; };
  std::uint32_t layer = 0;
  for (std::uint32_t number = first; number != 0; number = spheres_[number - 1].next)
    if (const Sphere& other = spheres_[number - 1]; equal(other))
      layer = std::max(layer, other.layer + (other.state == state ? 0 : 1));
  layer = std::min(layer, kMaxLayers);
  // One entry per sphere, layer and state is sufficient.
  for (std::uint32_t number = first; number != 0; number = spheres_[number - 1].next)
    if (const Sphere& other = spheres_[number - 1]; other.layer == layer && other.state == state && equal(other))
      return layer;
  spheres_.push_back({center, radius, state, layer, first});
  first = static_cast<std::uint32_t>(spheres_.size());
  return layer;
}

}  // namespace gs::render
