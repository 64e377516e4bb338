#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace gs::render {

/// Finds the spheres that overlap a given one among thousands: a bounding volume hierarchy, split at the middle of the
/// longest side. Used by one thread at a time.
class LightTree {
 public:
  struct Sphere {
    glm::vec3 center;
    float radius;  // >= 0; may be infinite
    std::uint16_t number;
  };

  void build(std::vector<Sphere> spheres);
  [[nodiscard]] bool empty() const { return spheres_.empty(); }
  /// Calls `found` for each sphere that overlaps the given one, in no particular order; for all if `radius` is
  /// negative.
  template <class Found>
  void each_near(const glm::vec3& center, float radius, Found&& found) const {
    if (!nodes_.empty()) visit(0, center, radius, found);
  }

 private:
  struct Node {
    glm::vec3 lower, upper;  // box around the spheres
    std::uint32_t first, last;
    std::uint32_t children;  // first of two consecutive children; 0 means none
  };
  static constexpr std::uint32_t kMaxOfALeaf = 8;

  [[nodiscard]] static bool meets(const Node& node, const glm::vec3& center, float radius);
  [[nodiscard]] static bool meets(const Sphere& sphere, const glm::vec3& center, float radius);
  void divide(std::uint32_t node);

  template <class Found>
  void visit(std::uint32_t number, const glm::vec3& center, float radius, Found&& found) const {
    const Node& node = nodes_[number];
    if (radius >= 0 && !meets(node, center, radius)) return;
    if (node.children != 0) {
      visit(node.children, center, radius, found);
      visit(node.children + 1, center, radius, found);
      return;
    }
    for (std::uint32_t i = node.first; i < node.last; ++i)
      if (radius < 0 || meets(spheres_[i], center, radius)) found(spheres_[i]);
  }

  std::vector<Sphere> spheres_;
  std::vector<Node> nodes_;
};

}  // namespace gs::render
