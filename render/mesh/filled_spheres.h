#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::render {

/// Spheres around the opaque items of a frame, and the layers of these items. A later layer is drawn later. The memory
/// of a frame is kept for the next, because an allocation for each item would take a third of its preparation.
class FilledSpheres {
 public:
  using State = std::array<std::uint64_t, 2>;

  /// Forgets the spheres. `count` is the usual number of spheres of a frame.
  void begin(std::size_t count);
  /// Returns the layer of an item, which is later than the layers of earlier items with an equal sphere and another
  /// state. So the last of several coincident faces in the file is visible: equal depths pass the depth test.
  [[nodiscard]] std::uint32_t layer_of(const glm::vec3& center, float radius, const State& state);

 private:
  struct Sphere {
    glm::vec3 center;
    float radius;
    State state;
    std::uint32_t layer;
    std::uint32_t next;  // number of the next sphere in the same bucket; 0 is none
  };
  std::vector<std::uint32_t> buckets_ = {0};  // numbers of their first spheres; a power of two
  std::vector<Sphere> spheres_;               // the sphere number n is at n - 1
};

}  // namespace gs::render
