#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace gs::render {

/// Bounding volume hierarchy that finds, among thousands of spheres, those that overlap a given sphere. Nodes are split
/// at the middle of their longest side. One thread at a time.
class LightTree {
 public:
  struct Sphere {
    glm::vec3 center;
    float radius;  // at least 0; may be infinite
    std::uint16_t number;
  };

  void build(std::vector<Sphere> spheres);
  [[nodiscard]] bool empty() const { return spheres_.empty(); }
  /// Calls `found` for each sphere that overlaps the given sphere, in no particular order. If `radius` is negative,
  /// calls it for all spheres.
  template <class Found>
  void each_near(const glm::vec3& center, float radius, Found&& found) const {
    if (!nodes_.empty()) visit(0, center, radius, found);
  }

 private:
  struct Node {
    glm::vec3 lower, upper;  // bounding box of the spheres
    std::uint32_t first, last;
    std::uint32_t children;  // index of the first of two consecutive children; 0 means no children
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
