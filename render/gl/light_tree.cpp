#include "render/gl/light_tree.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace gs::render {

bool LightTree::meets(const Node& node, const glm::vec3& center, float radius) {
  const glm::vec3 outside = glm::max(glm::max(node.lower - center, center - node.upper), glm::vec3(0));
  return !(glm::length(outside) > radius);  // `!` also accepts NaN; the later test of spheres rejects it
}

bool LightTree::meets(const Sphere& sphere, const glm::vec3& center, float radius) {
  return !(glm::length(sphere.center - center) > sphere.radius + radius);
}

void LightTree::build(std::vector<Sphere> spheres) {
  spheres_ = std::move(spheres);
  nodes_.clear();
  if (spheres_.empty()) return;
  nodes_.push_back({{}, {}, 0, static_cast<std::uint32_t>(spheres_.size()), 0});
  // The loop also reaches the children that divide() appends to nodes_.
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) divide(i);
}

void LightTree::divide(std::uint32_t number) {
  constexpr float kMax = std::numeric_limits<float>::max();
  const std::uint32_t first = nodes_[number].first, last = nodes_[number].last;
  glm::vec3 lower(kMax), upper(-kMax), least(kMax), most(-kMax);
  for (std::uint32_t i = first; i < last; ++i) {
    const Sphere& sphere = spheres_[i];
    lower = glm::min(lower, sphere.center - sphere.radius);
    upper = glm::max(upper, sphere.center + sphere.radius);
    least = glm::min(least, sphere.center);
    most = glm::max(most, sphere.center);
  }
  nodes_[number].lower = lower;
  nodes_[number].upper = upper;
  if (last - first <= kMaxOfALeaf) return;
  const glm::vec3 size = most - least;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(spheres_.begin() + first, spheres_.begin() + middle, spheres_.begin() + last,
                   [&](const Sphere& a, const Sphere& b) { return a.center[axis] < b.center[axis]; });
  nodes_[number].children = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({{}, {}, first, middle, 0});
  nodes_.push_back({{}, {}, middle, last, 0});
}

}  // namespace gs::render
