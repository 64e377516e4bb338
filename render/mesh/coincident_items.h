#pragma once

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <unordered_map>

namespace gs::render {

/// Drawing layers of the opaque items of a frame. Of coincident faces, the last in the file must be visible. So an item
/// gets a later layer than earlier items with an equal sphere and another state. Equal depths pass the depth test.
class CoincidentItems {
 public:
  using State = std::array<std::uint64_t, 2>;

  void clear() { filled_.clear(); }
  /// Returns the layer of an item with this bounding sphere. Later layers are drawn later.
  [[nodiscard]] std::uint32_t layer_of(const glm::vec3& center, float radius, const State& state) {
    constexpr std::uint32_t kMaxLayers = 8;
    const auto bits = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value)}; };
    const std::uint64_t key =
        (bits(center.x) * 0x9E3779B97F4A7C15u ^ bits(center.y) << 32 ^ bits(center.z)) * 0xC2B2AE3D27D4EB4Fu ^
        bits(radius);
    std::uint32_t layer = 0;
    const auto [first, last] = filled_.equal_range(key);
    for (auto other = first; other != last; ++other)
      if (other->second.center == center && other->second.radius == radius)
        layer = std::max(layer, other->second.layer + (other->second.state == state ? 0 : 1));
    layer = std::min(layer, kMaxLayers);
    // One entry per layer and state is sufficient.
    for (auto other = first; other != last; ++other)
      if (other->second.layer == layer && other->second.state == state && other->second.center == center) return layer;
    filled_.insert({key, {center, radius, state, layer}});
    return layer;
  }

 private:
  struct Filled {
    glm::vec3 center;
    float radius;
    State state;
    std::uint32_t layer;
  };
  std::unordered_multimap<std::uint64_t, Filled> filled_;  // by a hash of centre and radius
};

}  // namespace gs::render
