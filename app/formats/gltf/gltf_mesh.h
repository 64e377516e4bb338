#pragma once

#include "app/formats/common/scene_builder.h"
#include "app/formats/gltf/gltf_accessor.h"
#include "app/formats/gltf/gltf_material.h"

#include <tiny_gltf.h>

#include <glm/mat4x4.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Builder of the Shapes of glTF meshes. Builds a mesh only once, even if several nodes use it. Primitives share their
/// arrays.
class GltfMeshes {
 public:
  GltfMeshes(const tinygltf::Model& model, GltfAccessors& accessors, GltfMaterials& materials, SceneBuilder& builder)
      : model_(model), accessors_(accessors), materials_(materials), builder_(builder) {}

  /// Returns a mesh as one Shape or a Group of Shapes, in mesh space. Repeated calls return the same node. If the mesh
  /// does not exist or is empty, reports that and returns null.
  [[nodiscard]] vrml::NodeId node(int mesh);
  /// Returns the Shapes of a skinned mesh in world space. `joints` has the matrix of each joint from mesh space to
  /// world space.
  [[nodiscard]] vrml::MFNode skinned_shapes(int mesh, const std::vector<glm::mat4>& joints);

 private:
  using Indices = std::vector<std::uint32_t>;
  [[nodiscard]] vrml::MFNode make(int mesh, const std::vector<glm::mat4>* joints);
  [[nodiscard]] vrml::NodeId make_shape(const tinygltf::Primitive& primitive, const std::string& where,
                                        const std::vector<glm::mat4>* joints);
  [[nodiscard]] bool read_attributes(const tinygltf::Primitive& primitive, const GltfSurface& surface,
                                     const std::string& where, Geometry& geometry);
  [[nodiscard]] bool read_corners(const tinygltf::Primitive& primitive, const std::string& where, Geometry& geometry);
  void read_colors(int accessor, const GltfSurface& surface, const std::string& where, Geometry& geometry);
  void read_texture_coordinates(int accessor, const GltfSurface& surface, const std::string& where, Geometry& geometry);
  void skin(const tinygltf::Primitive& primitive, const std::vector<glm::mat4>& joints, const std::string& where,
            Geometry& geometry);
  /// Adds a note, the first time, that Gaussian splats lose their opacity or their spherical harmonics.
  void report_splats(const tinygltf::Primitive& primitive);
  std::optional<vrml::MFVec3f> vectors(int accessor);

  const tinygltf::Model& model_;
  GltfAccessors& accessors_;
  GltfMaterials& materials_;
  SceneBuilder& builder_;
  std::map<int, vrml::NodeId> nodes_;
  std::map<int, vrml::MFVec3f> vectors_;
  std::map<int, vrml::MFVec2f> texture_coordinates_;
  bool splats_reported_ = false;
};

}  // namespace gs::app
