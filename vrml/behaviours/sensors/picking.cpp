#include "vrml/events/execution.h"
#include "vrml/mesh/mesh_contacts.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <string_view>
#include <unordered_set>
#include <vector>

// Picking sensors (X3D clause 38). A sensor is evaluated after each change of the world.
namespace gs::vrml {
namespace {

struct Pick {
  enum : int {
    enabled,
    is_active,
    picked_geometry,
    picking_geometry,
    target,
    match,
    types,
    intersection,
    order,
    picked_point,
    picked_normal,
    picked_texture_coordinate
  };
};

constexpr std::size_t kMaxPicked = 1024;  // max geometries and points of one event

/// Target that a sensor has picked.
struct Picked {
  std::size_t place = 0;  // index in PlacedShapes::nodes
  double distance = 0;    // between the centres
  std::vector<SurfacePoint> points;
};

/// Test whether a picking geometry meets a target. Fills in the points of the target. `target_from_picking` transforms
/// between their spaces.
using Test = bool (*)(const Mesh& picking, const glm::dmat4& target_from_picking, const Mesh& target,
                      std::vector<SurfacePoint>& points);

// Reports whether the object types of a sensor and of a PickableGroup match (38.3.2).
bool types_match(const MFString& wanted, const MFString& own, std::string_view criterion) {
  const auto has_type = [](const MFString& types, std::string_view type) {
    return std::any_of(types.begin(), types.end(), [&](const SFString& one) { return one.view() == type; });
  };
  if (has_type(wanted, "NONE") || has_type(own, "NONE")) return false;
  if (has_type(wanted, "ALL") || has_type(own, "ALL")) return true;
  const auto matches =
      std::count_if(wanted.begin(), wanted.end(), [&](const SFString& type) { return has_type(own, type.view()); });
  if (criterion == "MATCH_EVERY") return matches == static_cast<std::ptrdiff_t>(wanted.size());
  if (criterion == "MATCH_ONLY_ONE") return matches == 1;
  return matches > 0;
}

class PickSearch {
 public:
  PickSearch(Execution& execution, EventNode sensor, Test test)
      : execution_(execution),
        sensor_(sensor),
        place_(execution.nodes().place_of(sensor)),
        exact_(execution.get<SFString>(sensor, Pick::intersection).view() == "GEOMETRY"),
        test_(test) {}

  /// Returns the picked targets, in the order that the sensor asks for.
  std::vector<Picked> run() {
    std::vector<Picked> found;
    PlacedShapes& shapes = execution_.shapes();
    const auto nodes = shapes.nodes();
    if (!execution_.budget().spend(nodes.size())) return found;
    const NodeId geometry = place_.scene->resolve(execution_.get<SFNode>(sensor_, Pick::picking_geometry));
    if (!geometry) return found;
    picking_ = shapes.mesh_of(*place_.scene, geometry);
    for (const PlacedNode& node : nodes)
      if (node.scene == place_.scene && node.node == place_.node && instances_.size() < Placement::kMaxPlaces)
        instances_.push_back({node.world_from_parent, box_of(picking_->bounds, node.world_from_parent)});
    if (picking_->empty()) return found;
    std::unordered_set<std::uint32_t> targets;
    for (const NodeId target : execution_.get<MFNode>(sensor_, Pick::target))
      if (const NodeId id = place_.scene->resolve(target)) targets.insert(id.index);
    std::vector<bool> below(nodes.size());
    for (std::size_t i = 1; i < nodes.size() && found.size() < kMaxPicked; ++i) {
      const PlacedNode& node = nodes[i];
      below[i] = below[node.parent] || (node.scene == place_.scene && targets.contains(node.node.index));
      if (!below[i] || !node.shape || !node.pickable || !has_type(nodes, node)) continue;
      Picked picked;
      picked.place = i;
      if (meets(node, picked)) found.push_back(std::move(picked));
    }
    sort(found);
    return found;
  }

 private:
  [[nodiscard]] bool has_type(std::span<const PlacedNode> nodes, const PlacedNode& node) const {
    static const MFString kAll{SFString("ALL")};
    const MFString& wanted = execution_.get<MFString>(sensor_, Pick::types);
    const MFString* own = &kAll;
    if (node.types != 0) {
      const PlacedNode& group = nodes[node.types];
      own = &group.scene->get<MFString>(group.node, "objectType");
    }
    return types_match(wanted, *own, execution_.get<SFString>(sensor_, Pick::match).view());
  }

  bool meets(const PlacedNode& node, Picked& picked) {
    const NodeId geometry = geometry_in(*node.scene, node.node);
    if (!execution_.budget().spend(EventBudget::kDelivery)) return false;
    const std::shared_ptr<const Mesh> mesh = execution_.shapes().mesh_of(*node.scene, geometry);
    const WideBox bounds = box_of(mesh->bounds, node.world_from_parent);
    if (bounds.empty()) return false;
    bool any = false;
    for (const Instance& own : instances_) {
      if (!do_overlap(bounds, own.bounds)) continue;
      if (exact_ && !execution_.budget().spend(mesh->indices.size() + picking_->indices.size())) return any;
      const glm::dmat4 target_from_picking = glm::inverse(node.world_from_parent) * own.world_from_picking;
      if (exact_ && !test_(*picking_, target_from_picking, *mesh, picked.points)) continue;
      const double distance = glm::length(bounds.center() - own.bounds.center());
      picked.distance = any ? std::min(picked.distance, distance) : distance;
      any = true;
    }
    return any;
  }

  void sort(std::vector<Picked>& found) const {
    const std::string_view order = execution_.get<SFString>(sensor_, Pick::order).view();
    const bool all = order == "ALL" || order == "ALL_SORTED";
    if (order != "ALL" && order != "ANY")
      std::stable_sort(found.begin(), found.end(),
                       [](const Picked& a, const Picked& b) { return a.distance < b.distance; });
    if (!all && found.size() > 1) found.resize(1);
  }

  Execution& execution_;
  EventNode sensor_;
  NodePlace place_;
  bool exact_;
  Test test_;
  std::shared_ptr<const Mesh> picking_;
  struct Instance {
    glm::dmat4 world_from_picking{1.0};
    WideBox bounds;  // of the picking geometry, in world space
  };
  std::vector<Instance> instances_;  // of the sensor
};

// Returns the node of the sensor's scene that stands for a picked geometry: the geometry itself, or the Inline that
// contains it.
NodeId node_for(std::span<const PlacedNode> nodes, std::size_t place, const SceneGraph& scene) {
  if (nodes[place].scene == &scene) return geometry_in(scene, nodes[place].node);
  for (std::size_t i = place; i != 0; i = nodes[i].parent)
    if (nodes[i].scene == &scene) return nodes[i].node;
  return {};
}

template <class T>
void send_list(Execution& execution, EventNode node, int event, T list) {
  if (execution.nodes().has_event(node, event) && !(execution.get<T>(node, event) == list))
    execution.send(node, event, std::move(list));
}

void send_picked(Execution& execution, EventNode node, const std::vector<Picked>& picked) {
  const SceneGraph& scene = *execution.nodes().place_of(node).scene;
  const auto nodes = execution.shapes().nodes();
  MFNode geometries;
  MFVec3f points, normals, coordinates;
  for (const Picked& one : picked) {
    if (const NodeId geometry = node_for(nodes, one.place, scene)) geometries.push_back(geometry);
    for (const SurfacePoint& point : one.points) {
      if (points.size() >= kMaxPicked) break;
      points.push_back(SFVec3f(point.point));
      normals.push_back(SFVec3f(point.normal));
      coordinates.push_back(SFVec3f(point.texture_coordinate, 0));
    }
  }
  const std::size_t bytes = geometries.size() * sizeof(NodeId) + points.size() * 3 * sizeof(SFVec3f);
  if (!execution.nodes().afford_most(node, bytes)) return;
  if (execution.has_sent(node, Pick::is_active) || execution.has_sent(node, Pick::picked_geometry))
    return execution.timers().call_at(node, execution.now());
  if (picked.empty() == execution.get<SFBool>(node, Pick::is_active))
    execution.send(node, Pick::is_active, SFBool{!picked.empty()});
  send_list(execution, node, Pick::picked_geometry, std::move(geometries));
  send_list(execution, node, Pick::picked_point, std::move(points));
  send_list(execution, node, Pick::picked_normal, std::move(normals));
  send_list(execution, node, Pick::picked_texture_coordinate, std::move(coordinates));
}

template <Test test>
void pick(Execution& execution, EventNode node) {
  std::vector<Picked> picked;
  if (execution.get<SFBool>(node, Pick::enabled)) picked = PickSearch(execution, node, test).run();
  send_picked(execution, node, picked);
}

// Points of the surface on the lines of a LinePickSensor, in the space of the target.
bool lines_meet(const Mesh& picking, const glm::dmat4& matrix, const Mesh& target, std::vector<SurfacePoint>& points) {
  if (picking.primitive != Mesh::Primitive::lines) return false;
  const auto at = [&](std::size_t i) {
    return glm::dvec3(matrix * glm::dvec4(picking.positions[picking.indices[i]], 1));
  };
  for (std::size_t i = 0; i + 1 < picking.indices.size() && points.size() < kMaxPicked; i += 2)
    append_crossings(target, at(i), at(i + 1), kMaxPicked, points);
  return !points.empty();
}

// Points of a PointPickSensor inside of the target, in the space of the sensor.
bool points_meet(const Mesh& picking, const glm::dmat4& matrix, const Mesh& target, std::vector<SurfacePoint>& points) {
  if (picking.primitive != Mesh::Primitive::points) return false;
  for (const std::uint32_t index : picking.indices) {
    const glm::dvec3 point(picking.positions[index]);
    if (points.size() < kMaxPicked && is_inside(target, glm::dvec3(matrix * glm::dvec4(point, 1))))
      points.push_back({point});
  }
  return !points.empty();
}

bool volumes_meet(const Mesh& picking, const glm::dmat4& matrix, const Mesh& target, std::vector<SurfacePoint>&) {
  return do_meet(picking, matrix, target);
}

void begin_picking(Execution& execution, EventNode node) {
  execution.shapes().add(node);
  execution.timers().look_again(node);
}

void end_picking(Execution& execution, EventNode node) { execution.shapes().remove(node); }

bool pick_event(Execution& execution, EventNode node, int, const FieldValue&) {
  execution.timers().look_again(node);
  return true;
}

// `outputs` is the number of outputs besides pickedGeometry.
template <Test test, int outputs>
constexpr Behaviour pick_sensor() {
  Behaviour behaviour{.events = {"enabled", "isActive", "pickedGeometry", "pickingGeometry", "pickTarget",
                                 "matchCriterion", "objectType", "intersectionType", "sortOrder"},
                      .initialize = begin_picking,
                      .on_event = pick_event,
                      .on_time = pick<test>,
                      .on_remove = end_picking};
  constexpr std::string_view kOutputs[] = {"pickedPoint", "pickedNormal", "pickedTextureCoordinate"};
  for (int i = 0; i < outputs; ++i) behaviour.events[static_cast<std::size_t>(Pick::picked_point + i)] = kOutputs[i];
  return behaviour;
}

}  // namespace

constexpr Behaviour kLinePickSensorBehaviour = pick_sensor<lines_meet, 3>();
constexpr Behaviour kPointPickSensorBehaviour = pick_sensor<points_meet, 1>();
constexpr Behaviour kPrimitivePickSensorBehaviour = pick_sensor<volumes_meet, 0>(),
                    kVolumePickSensorBehaviour = pick_sensor<volumes_meet, 0>();

}  // namespace gs::vrml
