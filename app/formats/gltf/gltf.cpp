#include "app/formats/gltf/gltf.h"

#include "app/formats/common/scene_builder.h"
#include "app/formats/gltf/gltf_accessor.h"
#include "app/formats/gltf/gltf_load.h"
#include "app/formats/gltf/gltf_material.h"
#include "app/formats/gltf/gltf_mesh.h"
#include "app/formats/gltf/gltf_placement.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <vector>

namespace gs::app {
namespace {

/// Required extensions that are supported or can be ignored.
constexpr std::array<std::string_view, 8> kKnownExtensions = {
    "KHR_materials_unlit", "KHR_texture_transform",           "KHR_mesh_quantization",  kDracoExtension,
    "KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_specular", "KHR_materials_ior"};

vrml::Rotation axis_and_angle(glm::quat q) {
  if (q.w < 0) q = -q;
  const glm::vec3 axis(q.x, q.y, q.z);
  const float sine = glm::length(axis);
  if (!(sine > 1e-7f)) return {};
  return {axis.x / sine, axis.y / sine, axis.z / sine, 2 * std::atan2(sine, q.w)};
}

class GltfImporter {
 public:
  GltfImporter(const tinygltf::Model& model, SceneBuilder& builder)
      : model_(model),
        builder_(builder),
        accessors_(model, builder.scene()),
        materials_(model, accessors_, builder),
        meshes_(model, accessors_, materials_, builder) {}

  void run() {
    for (const std::string& extension : model_.extensionsRequired)
      if (std::find(kKnownExtensions.begin(), kKnownExtensions.end(), extension) == kKnownExtensions.end())
        builder_.fail("the extension " + extension.substr(0, 100) + ", which this asset requires, is not supported");
    walk();
    build();
  }

 private:
  struct Visit {
    int node;
    std::size_t parent;  // index of the parent in visits_; kNoParent for roots
    std::size_t depth;
    glm::mat4 world;
    bool useful = false;  // the node or a descendant has visible content
    vrml::NodeId transform;
    vrml::MFNode children;
  };
  static constexpr std::size_t kNoParent = SIZE_MAX;

  [[nodiscard]] bool exists(int node) const { return gs::app::exists(model_, node); }
  [[nodiscard]] const tinygltf::Node& node(const Visit& visit) const {
    return model_.nodes[static_cast<std::size_t>(visit.node)];
  }
  /// Lists the nodes of the scene: parents before children, each node once, so that the result is a tree.
  void walk() {
    visited_.assign(model_.nodes.size(), kNoParent);
    for (const int root : scene_roots(model_)) visit(root, kNoParent);
    for (std::size_t i = 0; i < visits_.size(); ++i) {
      const tinygltf::Node& n = node(visits_[i]);
      for (const int child : n.children) visit(child, i);
    }
    for (std::size_t i = visits_.size(); i-- > 0;) {
      const tinygltf::Node& n = node(visits_[i]);
      visits_[i].useful |= n.mesh >= 0 || n.camera >= 0;
      if (visits_[i].useful && visits_[i].parent != kNoParent) visits_[visits_[i].parent].useful = true;
    }
  }

  void visit(int index, std::size_t parent) {
    if (!exists(index)) {
      builder_.fail("node " + std::to_string(index) + " does not exist");
      return;
    }
    std::size_t& place = visited_[static_cast<std::size_t>(index)];
    if (place != kNoParent) {
      builder_.fail("node " + std::to_string(index) + " has more than one parent; expected a tree");
      return;
    }
    const std::size_t depth = parent == kNoParent ? 1 : visits_[parent].depth + 1;
    if (depth > builder_.scene().limits().nesting) {
      builder_.fail("node " + std::to_string(index) + " is nested too deeply; it is left out");
      return;
    }
    place = visits_.size();
    const glm::mat4 outer = parent == kNoParent ? glm::mat4(1.0f) : visits_[parent].world;
    const Placement placement = placement_of(model_.nodes[static_cast<std::size_t>(index)]);
    visits_.push_back({index, parent, depth, outer * placement.matrix(), false, {}, {}});
  }

  void build() {
    // Build children before parents, so that each `children` field is set only once.
    for (std::size_t i = visits_.size(); i-- > 0;)
      if (visits_[i].useful) build(visits_[i]);
    for (const Visit& visit : visits_) {
      builder_.name(visit.transform, node(visit).name);
      if (visit.parent == kNoParent) builder_.add_root(visit.transform);
    }
    for (const vrml::NodeId shape : world_shapes_) builder_.add_root(shape);
  }

  void build(Visit& visit) {
    const tinygltf::Node& n = node(visit);
    vrml::MFNode content;
    if (n.camera >= 0) add_viewpoint(n, content);
    if (n.mesh >= 0) add_mesh(n, content);
    // Children were added in reverse order.
    for (std::size_t i = visit.children.size(); i-- > 0;) content.push_back(visit.children[i]);
    visit.children.clear();
    if (content.empty()) return;

    const Placement placement = placement_of(n);
    if (placement.sheared)
      builder_.warn("node " + std::to_string(visit.node) + ": its matrix is not a translation, rotation and scale");
    visit.transform = builder_.make(vrml::NodeKind::transform);
    builder_.set(visit.transform, "translation", placement.translation);
    builder_.set(visit.transform, "rotation", axis_and_angle(placement.rotation));
    builder_.set(visit.transform, "scale", placement.scale);
    builder_.set(visit.transform, "children", std::move(content));
    if (visit.transform && visit.parent != kNoParent) visits_[visit.parent].children.push_back(visit.transform);
  }

  void add_viewpoint(const tinygltf::Node& n, vrml::MFNode& content) {
    if (static_cast<std::size_t>(n.camera) >= model_.cameras.size()) {
      builder_.fail("camera " + std::to_string(n.camera) + " does not exist");
      return;
    }
    const tinygltf::Camera& camera = model_.cameras[static_cast<std::size_t>(n.camera)];
    if (camera.type != "perspective") {
      builder_.note("an orthographic camera is left out, because VRML97 has none");
      return;
    }
    // The field of view of VRML97 applies to the smaller side of the window (6.53).
    float field_of_view = finite_float(camera.perspective.yfov);
    const float aspect = finite_float(camera.perspective.aspectRatio);
    if (aspect > 0 && aspect < 1) field_of_view = 2 * std::atan(std::tan(field_of_view / 2) * aspect);
    const vrml::NodeId viewpoint = builder_.make(vrml::NodeKind::viewpoint);
    builder_.set(viewpoint, "position", vrml::SFVec3f(0.0f));
    if (field_of_view > 0 && field_of_view < std::numbers::pi_v<float>)
      builder_.set(viewpoint, "fieldOfView", field_of_view);
    builder_.set(viewpoint, "description", vrml::String(camera.name.empty() ? n.name : camera.name));
    if (viewpoint) content.push_back(viewpoint);
  }

  void add_mesh(const tinygltf::Node& n, vrml::MFNode& content) {
    const std::vector<glm::mat4> joints = n.skin >= 0 ? joints_of(n.skin) : std::vector<glm::mat4>{};
    if (joints.empty()) {
      if (const vrml::NodeId mesh = meshes_.node(n.mesh)) content.push_back(mesh);
      return;
    }
    // A skin places the vertices in world space. The transform of the node is ignored (glTF 2.0 3.7.3.2).
    world_shapes_.append(meshes_.skinned_shapes(n.mesh, joints).span());
  }

  /// Returns a matrix for each joint, from mesh space in the bind pose to world space. Returns an empty list if the
  /// skin is invalid.
  std::vector<glm::mat4> joints_of(int index) {
    if (static_cast<std::size_t>(index) >= model_.skins.size()) {
      builder_.fail("skin " + std::to_string(index) + " does not exist");
      return {};
    }
    const tinygltf::Skin& skin = model_.skins[static_cast<std::size_t>(index)];
    if (!accessors_.charge(skin.joints.size() * sizeof(glm::mat4))) {
      builder_.fail("skin " + std::to_string(index) + ": " + accessors_.problem());
      return {};
    }
    std::vector<glm::mat4> joints(skin.joints.size(), glm::mat4(1.0f));
    const auto inverse = skin.inverseBindMatrices >= 0 ? accessors_.floats(skin.inverseBindMatrices, 16) : std::nullopt;
    if (skin.inverseBindMatrices >= 0 && (!inverse || inverse->size() < 16 * joints.size())) {
      builder_.warn("skin " + std::to_string(index) + ": its inverse bind matrices cannot be read");
      return {};
    }
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const int joint = skin.joints[i];
      const bool placed = exists(joint) && visited_[static_cast<std::size_t>(joint)] != kNoParent;
      if (placed) joints[i] = visits_[visited_[static_cast<std::size_t>(joint)]].world;
      if (!inverse) continue;
      glm::mat4 bind(1.0f);
      for (int k = 0; k < 16; ++k) bind[k / 4][k % 4] = (*inverse)[16 * i + static_cast<std::size_t>(k)];
      joints[i] = joints[i] * bind;
    }
    return joints;
  }

  const tinygltf::Model& model_;
  SceneBuilder& builder_;
  GltfAccessors accessors_;
  GltfMaterials materials_;
  GltfMeshes meshes_;
  std::vector<Visit> visits_;
  std::vector<std::size_t> visited_;  // index in visits_ for each node of the model
  vrml::MFNode world_shapes_;
};

}  // namespace

void import_gltf(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics,
                 const ReadFile& read_file) {
  SceneBuilder builder(scene, diagnostics);
  const auto model = load_gltf(bytes, read_file, builder);
  if (model) GltfImporter(*model, builder).run();
}

}  // namespace gs::app
