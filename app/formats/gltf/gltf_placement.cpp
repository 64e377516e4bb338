#include "app/formats/gltf/gltf_placement.h"

#include "app/formats/gltf/gltf_material.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

glm::vec3 vector_of(const std::vector<double>& values, glm::vec3 otherwise) {
  if (values.size() < 3) return otherwise;
  return {finite_float(values[0]), finite_float(values[1]), finite_float(values[2])};
}

glm::quat unit(const glm::quat& q) {
  const float length = glm::length(q);
  return std::isfinite(length) && length > 0 ? q / length : glm::quat(1, 0, 0, 0);
}

/// Decomposes a matrix into translation, rotation and scale, as glTF requires.
Placement decomposed(const std::vector<double>& values) {
  glm::mat4 m(1.0f);
  for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = finite_float(values[static_cast<std::size_t>(i)]);
  Placement placement;
  placement.translation = glm::vec3(m[3]);
  glm::mat3 axes(m);
  for (int i = 0; i < 3; ++i) placement.scale[i] = glm::length(axes[i]);
  // The matrix is mirrored and not a rotation, so one axis gets a negative scale.
  if (glm::dot(glm::cross(axes[0], axes[1]), axes[2]) < 0) placement.scale.x = -placement.scale.x;
  for (int i = 0; i < 3; ++i) {
    if (!(std::abs(placement.scale[i]) > 0) || !std::isfinite(placement.scale[i])) return placement;
    axes[i] /= placement.scale[i];
  }
  constexpr float kTolerance = 1e-3f;
  placement.sheared = std::abs(glm::dot(axes[0], axes[1])) > kTolerance ||
                      std::abs(glm::dot(axes[1], axes[2])) > kTolerance ||
                      std::abs(glm::dot(axes[2], axes[0])) > kTolerance;
  placement.rotation = unit(glm::quat_cast(axes));
  return placement;
}

}  // namespace

Placement placement_of(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return decomposed(node.matrix);
  Placement placement;
  placement.translation = vector_of(node.translation, placement.translation);
  placement.scale = vector_of(node.scale, placement.scale);
  if (node.rotation.size() == 4)
    placement.rotation = unit(glm::quat(finite_float(node.rotation[3]), finite_float(node.rotation[0]),
                                        finite_float(node.rotation[1]), finite_float(node.rotation[2])));
  return placement;
}

std::vector<int> scene_roots(const tinygltf::Model& model) {
  if (!model.scenes.empty()) {
    const auto wanted = static_cast<std::size_t>(std::max(model.defaultScene, 0));
    return model.scenes[wanted < model.scenes.size() ? wanted : 0].nodes;
  }
  // Without a scene, show all nodes that have no parent.
  std::vector<bool> is_child(model.nodes.size());
  for (const tinygltf::Node& n : model.nodes)
    for (const int child : n.children)
      if (exists(model, child)) is_child[static_cast<std::size_t>(child)] = true;
  std::vector<int> roots;
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  return roots;
}

}  // namespace gs::app
