#include "app/loading/fetch/importance.h"

#include "vrml/event_model/behaviour.h"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

namespace gs::app {
namespace {

constexpr std::size_t kMaxVisits = 200'000, kMaxLookedDepth = 256;
constexpr float kUnknown = 0.25f;  // apparent size of nodes without bounds, nearby

class Surveyor {
 public:
  Surveyor(const std::unordered_set<const vrml::Node*>& wanted, const glm::dvec3& viewer)
      : wanted_(wanted), viewer_(viewer) {}

  void run(const vrml::SceneGraph& scene) {
    push_all(scene, scene.roots(), glm::dmat4(1), 0);
    while (!open_.empty() && visits_++ < kMaxVisits && found_.size() < wanted_.size()) {
      const Place place = open_.back();
      open_.pop_back();
      visit(place);
    }
  }
  std::unordered_map<const vrml::Node*, float> take() { return std::move(found_); }

 private:
  struct Place {
    const vrml::SceneGraph* scene;
    vrml::NodeId id;
    glm::dmat4 world_from_local;
    std::size_t depth;
  };

  void push_all(const vrml::SceneGraph& scene, const vrml::MFNode& nodes, const glm::dmat4& matrix, std::size_t depth) {
    if (depth > kMaxLookedDepth) return;
    for (const vrml::NodeId id : nodes) open_.push_back({&scene, id, matrix, depth});
  }

  void visit(const Place& place) {
    const vrml::NodeId id = place.scene->resolve(place.id);
    if (!id) return;
    const vrml::Node& node = place.scene->node(id);
    glm::dmat4 matrix = place.world_from_local;
    if (node.type->kind != vrml::NodeType::Kind::built_in) return;
    if (const vrml::Behaviour* behaviour = node.type->behaviour;
        behaviour && behaviour->parent_from_local && vrml::has(node.type->role, vrml::Role::grouping))
      matrix *= behaviour->parent_from_local(*place.scene, node);
    if (wanted_.contains(&node)) keep(&node, size_of(*place.scene, id, matrix));
    if (const vrml::SceneGraph* inlined = place.scene->inlines().of(id))
      push_all(*inlined, inlined->roots(), matrix, place.depth + 1);
    if (const vrml::GeoTiles* tiles = place.scene->inlines().tiles_of(id)) {
      push_all(*place.scene, tiles->root, matrix, place.depth + 1);
      push_all(*place.scene, tiles->children, matrix, place.depth + 1);
    }
    for (int slot = 0; slot < static_cast<int>(node.type->defaults.size()); ++slot) {
      if (const auto* many = std::get_if<vrml::MFNode>(&node.values[slot]))
        push_all(*place.scene, *many, matrix, place.depth + 1);
      else if (const auto* one = std::get_if<vrml::SFNode>(&node.values[slot]); one && *one)
        open_.push_back({place.scene, *one, matrix, place.depth + 1});
    }
  }

  void keep(const vrml::Node* node, float size) {
    float& known = found_.try_emplace(node, 0.0f).first->second;
    known = std::max(known, size);
  }

  float size_of(const vrml::SceneGraph& scene, vrml::NodeId id, const glm::dmat4& matrix) const {
    glm::vec3 center(0), size(-1);
    const vrml::NodeType& type = *scene.node(id).type;
    if (type.find_field("bboxCenter") && type.find_field("bboxSize")) {
      center = scene.get<vrml::SFVec3f>(id, "bboxCenter");
      size = scene.get<vrml::SFVec3f>(id, "bboxSize");
    }
    const glm::dvec3 middle(matrix * glm::dvec4(center, 1));
    const double distance = glm::distance(middle, viewer_);
    if (!std::isfinite(distance)) return 0;
    if (!(size.x >= 0 && size.y >= 0 && size.z >= 0)) return kUnknown / (1 + 0.01f * static_cast<float>(distance));
    const double radius = 0.5 * glm::length(glm::dmat3(matrix) * glm::dvec3(size));
    return static_cast<float>(radius / std::max(distance, radius + 1e-30));
  }

  const std::unordered_set<const vrml::Node*>& wanted_;
  glm::dvec3 viewer_;
  std::vector<Place> open_;
  std::size_t visits_ = 0;
  std::unordered_map<const vrml::Node*, float> found_;
};

}  // namespace

std::unordered_map<const vrml::Node*, float> importance_of(const vrml::SceneGraph& scene,
                                                           const std::unordered_set<const vrml::Node*>& wanted,
                                                           const glm::dvec3& viewer) {
  Surveyor surveyor(wanted, viewer);
  if (!wanted.empty()) surveyor.run(scene);
  return surveyor.take();
}

}  // namespace gs::app
