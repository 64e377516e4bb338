#include "vrml/events/placed_shapes.h"

#include "vrml/events/execution.h"

#include <algorithm>

namespace gs::vrml {
namespace {

constexpr int kMaxNesting = 256;
constexpr std::size_t kMaxMeshBytes = std::size_t{64} << 20;

const FieldValue* field_of(const Node& node, std::string_view name) {
  const InterfaceDeclaration* field = node.type->find_field(name);
  return field ? &node.values[field->slot] : nullptr;
}

bool is_moved(const Node& node) {
  return has(node.type->role, Role::grouping) || has(node.type->role, Role::geometry) ||
         has(node.type->role, Role::geometric_property) || node.type->read_as == NodeKind::shape;
}

}  // namespace

NodeId geometry_in(const SceneGraph& scene, NodeId shape) {
  const FieldValue* const geometry = field_of(scene.node(shape), "geometry");
  const auto* const given = geometry ? std::get_if<SFNode>(geometry) : nullptr;
  return given ? scene.resolve(*given) : NodeId{};
}

void PlacedShapes::add(EventNode sensor) {
  if (std::find(sensors_.begin(), sensors_.end(), sensor) == sensors_.end()) sensors_.push_back(sensor);
}

void PlacedShapes::remove(EventNode sensor) { std::erase(sensors_, sensor); }

// Sensors are called in the next step, so that they see the state after the whole cascade.
void PlacedShapes::note_change(const Node* node) {
  if (sensors_.empty() || (node && !is_moved(*node))) return;
  forget_meshes(node);
  known_ = false;
  if (std::exchange(alarmed_, true)) return;
  for (const EventNode sensor : sensors_) execution_.timers().call_at(sensor, execution_.now());
}

// Discards the meshes that depend on a node: its own mesh, or those of geometries with this Coordinate or similar.
void PlacedShapes::forget_meshes(const Node* changed) {
  if (!changed) {
    meshes_.clear();
    mesh_bytes_ = 0;
    return;
  }
  if (has(changed->type->role, Role::geometry)) meshes_.erase(changed);
  if (!has(changed->type->role, Role::geometric_property)) return;
  const auto refers = [&](const auto& made) {
    const SceneGraph& scene = *made.second.scene;
    const std::span<const FieldValue> values(made.first->values, made.first->type->defaults.size());
    return std::any_of(values.begin(), values.end(), [&](const FieldValue& value) {
      const auto* const property = std::get_if<SFNode>(&value);
      const NodeId id = property ? scene.resolve(*property) : NodeId{};
      return id && &scene.node(id) == changed;
    });
  };
  std::erase_if(meshes_, refers);
}

void PlacedShapes::forget() {
  known_ = false;
  nodes_.clear();
  meshes_.clear();
  mesh_bytes_ = 0;
}

std::span<const PlacedNode> PlacedShapes::nodes() {
  alarmed_ = false;
  if (!std::exchange(known_, true)) collect();
  return nodes_;
}

void PlacedShapes::collect() {
  nodes_.assign(1, {});
  const SceneGraph& root = execution_.scenes().root();
  visit(root, root.roots(), 0, glm::dmat4(1), 0);
  (void)execution_.budget().spend(nodes_.size());
}

void PlacedShapes::visit(const SceneGraph& scene, const MFNode& children, std::uint32_t parent, const glm::dmat4& world,
                         int depth) {
  for (const NodeId child : children)
    if (const NodeId id = scene.resolve(child)) visit_node(scene, id, parent, world, depth);
}

void PlacedShapes::visit_node(const SceneGraph& scene, NodeId id, std::uint32_t parent, const glm::dmat4& world,
                              int depth) {
  const Node& node = scene.node(id);
  const bool groups = has(node.type->role, Role::grouping);
  const bool shape = node.type->read_as == NodeKind::shape;
  if (nodes_.size() >= kMaxNodes || depth >= kMaxNesting || !(groups || shape || has(node.type->role, Role::sensor)))
    return;
  const auto place = static_cast<std::uint32_t>(nodes_.size());
  PlacedNode made{&scene, id, parent, world, world, shape, nodes_[parent].pickable, nodes_[parent].types};
  const Behaviour* const behaviour = node.type->behaviour;
  if (groups && behaviour && behaviour->parent_from_local)
    made.world_from_inside *= behaviour->parent_from_local(scene, node);
  if (const FieldValue* const pickable = groups ? field_of(node, "pickable") : nullptr) {
    made.pickable = made.pickable && *std::get_if<SFBool>(pickable);
    made.types = place;
  }
  nodes_.push_back(made);
  if (!groups) return;
  const glm::dmat4 inside = made.world_from_inside;
  if (const SceneGraph* const content = scene.inlines().of(id))
    return visit(*content, content->roots(), place, inside, depth + 1);
  const GeoTiles* const tiles = scene.inlines().tiles_of(id);
  if (const MFNode* const shown = tiles ? tiles->shown() : nullptr)
    return visit(scene, *shown, place, inside, depth + 1);
  const FieldValue* const choice = field_of(node, "whichChoice");
  const auto* const which = choice ? std::get_if<SFInt32>(choice) : nullptr;
  const bool first_only = node.type->read_as == NodeKind::lod;
  for (const FieldValue& value : std::span<const FieldValue>(node.values, node.type->defaults.size())) {
    const auto* const children = std::get_if<MFNode>(&value);
    if (!children) continue;
    if (!which && !first_only) {
      visit(scene, *children, place, inside, depth + 1);
      continue;
    }
    const std::int64_t index = which ? *which : 0;
    if (index < 0 || index >= static_cast<std::int64_t>(children->size())) continue;
    if (const NodeId chosen = scene.resolve((*children)[static_cast<std::size_t>(index)]))
      visit_node(scene, chosen, place, inside, depth + 1);
  }
}

bool PlacedShapes::is_below(std::size_t index, const SceneGraph& scene, NodeId of) const {
  for (std::size_t i = index; i != 0; i = nodes_[i].parent)
    if (nodes_[i].scene == &scene && nodes_[i].node == of) return true;
  return false;
}

std::size_t PlacedShapes::find(const SceneGraph& scene, NodeId node) {
  const auto all = nodes();
  for (std::size_t i = 1; i < all.size(); ++i)
    if (all[i].scene == &scene && all[i].node == node) return i;
  return 0;
}

std::shared_ptr<const Mesh> PlacedShapes::mesh_of(const SceneGraph& scene, NodeId geometry) {
  static const auto kNone = std::make_shared<const Mesh>();
  if (!geometry || !scene.contains(geometry)) return kNone;
  if (mesh_bytes_ > kMaxMeshBytes) {
    meshes_.clear();
    mesh_bytes_ = 0;
  }
  Made& made = meshes_[&scene.node(geometry)];
  std::shared_ptr<const Mesh>& mesh = made.mesh;
  if (!mesh) {
    made.scene = &scene;
    mesh = std::make_shared<const Mesh>(tessellate(scene, geometry));
    mesh_bytes_ += mesh->cost();
    (void)execution_.budget().spend(mesh->indices.size());
  }
  return mesh;
}

}  // namespace gs::vrml
