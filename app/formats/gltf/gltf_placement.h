#pragma once

#include <tiny_gltf.h>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace gs::app {

/// Transformation of a glTF node relative to its parent.
struct Placement {
  glm::vec3 translation{0.0f}, scale{1.0f};
  glm::quat rotation{1, 0, 0, 0};
  bool sheared = false;

  [[nodiscard]] glm::mat4 matrix() const {
    glm::mat4 m = glm::mat4_cast(rotation);
    for (int i = 0; i < 3; ++i) m[i] *= scale[i];
    m[3] = glm::vec4(translation, 1.0f);
    return m;
  }
};

/// Reports whether a node exists.
[[nodiscard]] inline bool exists(const tinygltf::Model& model, int node) {
  return node >= 0 && static_cast<std::size_t>(node) < model.nodes.size();
}
/// Returns the placement of a node. Numbers that are not finite become 0.
[[nodiscard]] Placement placement_of(const tinygltf::Node& node);
/// Returns the root nodes of the default scene. Without a scene, returns all nodes that have no parent.
[[nodiscard]] std::vector<int> scene_roots(const tinygltf::Model& model);

}  // namespace gs::app
