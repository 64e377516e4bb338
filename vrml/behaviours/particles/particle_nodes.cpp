#include "vrml/behaviours/particles/particle_nodes.h"

#include "vrml/mesh/mesh.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

namespace gs::vrml {
namespace {

constexpr int kSurfaceSegments = 16;    // of curved primitives, around a full circle
constexpr float kMaxNumber = 1e9F;      // maximum of speeds, forces, sizes and similar values
constexpr std::size_t kMaxModels = 64;  // maximum physics models of a system

template <class T>
T particle_field(const SceneGraph& scene, NodeId node, std::string_view name, T otherwise) {
  const InterfaceDeclaration* const field = scene.node(node).type->find_field(name);
  const T* const value = field ? std::get_if<T>(&scene.node(node).values[field->slot]) : nullptr;
  return value ? *value : otherwise;
}

// Returns a number of a node, clamped to 0 and `most`; 0 if it is not a number.
float amount(const SceneGraph& scene, NodeId node, std::string_view name, float most = kMaxNumber) {
  const float value = particle_field<SFFloat>(scene, node, name, 0);
  return value > 0 ? std::min(value, most) : 0;
}

glm::vec3 vector(const SceneGraph& scene, NodeId node, std::string_view name) {
  glm::vec3 value = particle_field<SFVec3f>(scene, node, name, SFVec3f(0));
  for (int i = 0; i < 3; ++i) value[i] = std::isnan(value[i]) ? 0 : std::clamp(value[i], -kMaxNumber, kMaxNumber);
  return value;
}

glm::vec3 direction(const SceneGraph& scene, NodeId node) {
  const glm::vec3 given = vector(scene, node, "direction");
  const float length = glm::length(given);
  return length > 0 ? given / length : glm::vec3(0);
}

/// Digest of the values of nodes. Of large lists, it covers the address, the length and some of the elements.
class ValueDigest {
 public:
  void add(const SceneGraph& scene, NodeId id, int depth) {
    id = scene.resolve(id);
    mix(id.index);
    if (!id || depth == 0) return;
    const Node& node = scene.node(id);
    mix(std::bit_cast<std::uintptr_t>(&node));
    for (const FieldValue& value : std::span<const FieldValue>(node.values, node.type->defaults.size())) {
      if (const auto* const inner = std::get_if<SFNode>(&value)) add(scene, *inner, depth - 1);
      std::visit([&](const auto& one) { add_value(one); }, value);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  void mix(std::uint64_t number) { state_ = (state_ ^ number) * 0x9E3779B97F4A7C15 + (state_ >> 29); }
  template <class T>
  void add_value(const T& one) {
    if constexpr (std::is_same_v<T, float>)
      mix(std::bit_cast<std::uint32_t>(one));
    else if constexpr (std::is_integral_v<T>)
      mix(static_cast<std::uint64_t>(one));
    else if constexpr (std::is_same_v<T, glm::vec3> || std::is_same_v<T, glm::vec2>)
      for (int i = 0; i < T::length(); ++i) add_value(one[i]);
  }
  template <class T>
  void add_value(const Array<T>& list) {
    constexpr std::size_t kSamples = 64;
    mix(std::bit_cast<std::uintptr_t>(list.data()));
    mix(list.size());
    const std::size_t stride = std::max<std::size_t>(list.size() / kSamples, 1);
    for (std::size_t i = 0; i < list.size(); i += stride) add_value(list[i]);
  }

  std::uint64_t state_ = 0x51ED27;
};

constexpr int kDigestDepth = 3;

ParticleEmitter::Kind kind_of(NodeKind kind) {
  using Kind = ParticleEmitter::Kind;
  switch (kind) {
    case NodeKind::point_emitter:
      return Kind::point;
    case NodeKind::cone_emitter:
      return Kind::cone;
    case NodeKind::explosion_emitter:
      return Kind::explosion;
    case NodeKind::polyline_emitter:
      return Kind::polyline;
    case NodeKind::surface_emitter:
      return Kind::surface;
    case NodeKind::volume_emitter:
      return Kind::volume;
    default:
      return Kind::none;
  }
}

// Returns the points of the field `coord`.
std::vector<glm::vec3> points_of_emitter(const SceneGraph& scene, NodeId emitter) {
  const NodeId coord = scene.resolve(particle_field<SFNode>(scene, emitter, "coord", {}));
  std::vector<glm::vec3> points;
  if (!coord) return points;
  for (const glm::vec3& point : particle_field<MFVec3f>(scene, coord, "point", {})) points.push_back(point);
  if (points.empty())
    for (const glm::dvec3& point : particle_field<MFVec3d>(scene, coord, "point", {})) points.emplace_back(point);
  return points;
}

// Calls `visit` for each run of valid indices of coordIndex. An empty list means all points in order.
template <class Visit>
void for_runs(const SceneGraph& scene, NodeId emitter, const std::vector<glm::vec3>& points, const Visit& visit) {
  const auto indices = particle_field<MFInt32>(scene, emitter, "coordIndex", {});
  std::vector<std::uint32_t> run;
  bool any = false;
  for (std::size_t i = 0; i <= indices.size(); ++i) {
    const std::int32_t index = i < indices.size() ? indices[i] : -1;
    if (index >= 0) {
      any = true;
      if (static_cast<std::size_t>(index) < points.size()) run.push_back(static_cast<std::uint32_t>(index));
      continue;
    }
    if (!run.empty()) visit(run);
    run.clear();
  }
  if (any) return;
  for (std::uint32_t i = 0; i < points.size(); ++i) run.push_back(i);
  visit(run);
}

// Returns the faces of a VolumeEmitter as fans of triangles. Crossings of a line with a fan have the right parity even
// for a concave face.
Mesh mesh_of_volume(const SceneGraph& scene, NodeId emitter) {
  const std::vector<glm::vec3> points = points_of_emitter(scene, emitter);
  Mesh mesh;
  for_runs(scene, emitter, points, [&](const std::vector<std::uint32_t>& face) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i)
      for (const std::uint32_t corner : {face[0], face[i], face[i + 1]}) mesh.indices.push_back(corner);
  });
  mesh.positions.append(points);
  return mesh;
}

void read_physics(ParticleSettings& settings, const SceneGraph& scene, NodeId model) {
  if (!particle_field<SFBool>(scene, model, "enabled", true)) return;
  switch (scene.node(model).type->read_as) {
    case NodeKind::force_physics:
      settings.force += vector(scene, model, "force");
      break;
    case NodeKind::wind_physics:
      settings.winds.push_back({direction(scene, model), amount(scene, model, "speed", 1e4F),
                                amount(scene, model, "gustiness", 1e4F), amount(scene, model, "turbulence", 1)});
      break;
    default:
      break;
  }
}

}  // namespace

ParticleSettings ParticleNodes::read(const SceneGraph& scene, NodeId system, const Afford& afford) {
  ParticleSettings settings;
  settings.emitter = emitter(scene, scene.resolve(particle_field<SFNode>(scene, system, "emitter", {})), afford);
  settings.creates = particle_field<SFBool>(scene, system, "createParticles", true);
  const SFInt32 most = particle_field<SFInt32>(scene, system, "maxParticles", 0);
  settings.most = std::min(static_cast<std::size_t>(std::max(most, 0)), ParticleSettings::kMaxParticles);
  settings.lifetime = amount(scene, system, "particleLifetime", ParticleSettings::kLongestLife);
  if (settings.lifetime > 0) settings.lifetime = std::max(settings.lifetime, ParticleSettings::kShortestLife);
  settings.lifetime_variation = amount(scene, system, "lifetimeVariation", 1);
  const SFVec2f size = particle_field<SFVec2f>(scene, system, "particleSize", SFVec2f(0));
  for (int i = 0; i < 2; ++i) settings.size[i] = size[i] > 0 ? std::min(size[i], kMaxNumber) : 0;
  const auto models = particle_field<MFNode>(scene, system, "physics", {});
  for (std::size_t i = 0; i < models.size() && i < kMaxModels; ++i) {
    const NodeId model = scene.resolve(models[i]);
    if (!model) continue;
    read_physics(settings, scene, model);
    if (scene.node(model).type->read_as != NodeKind::bounded_physics ||
        !particle_field<SFBool>(scene, model, "enabled", true))
      continue;
    const NodeId geometry = scene.resolve(particle_field<SFNode>(scene, model, "geometry", {}));
    if (auto bound = geometry ? surface(scene, geometry, afford) : nullptr) settings.bounds.push_back(std::move(bound));
  }
  return settings;
}

ParticleEmitter ParticleNodes::emitter(const SceneGraph& scene, NodeId node, const Afford& afford) {
  ParticleEmitter made;
  if (!node) return made;
  made.kind = kind_of(scene.node(node).type->read_as);
  if (made.kind == ParticleEmitter::Kind::none) return made;
  made.on = particle_field<SFBool>(scene, node, "on", true);
  made.position = vector(scene, node, "position");
  made.direction = direction(scene, node);
  made.angle = amount(scene, node, "angle", 4);
  made.speed = amount(scene, node, "speed");
  made.variation = amount(scene, node, "variation", 1e4F);
  made.mass = amount(scene, node, "mass");
  made.surface_area = amount(scene, node, "surfaceArea");
  if (made.kind == ParticleEmitter::Kind::polyline) {
    made.lines = lines(scene, node, afford);
    made.on = made.on && made.lines;
  } else if (made.kind == ParticleEmitter::Kind::surface) {
    const NodeId geometry = scene.resolve(particle_field<SFNode>(scene, node, "surface", {}));
    made.surface = geometry ? surface(scene, geometry, afford) : nullptr;
    made.on = made.on && made.surface;
  } else if (made.kind == ParticleEmitter::Kind::volume) {
    made.surface = surface(scene, node, afford);
    made.on = made.on && made.surface;
  }
  return made;
}

// Returns the surface of a geometry, or the volume of a VolumeEmitter; null if it has no faces.
std::shared_ptr<const SurfaceTree> ParticleNodes::surface(const SceneGraph& scene, NodeId geometry,
                                                          const Afford& afford) {
  ValueDigest digest;
  digest.add(scene, geometry, kDigestDepth);
  Kept<SurfaceTree>& kept = surfaces_[geometry.index];
  if (kept.digest == digest.value()) return kept.object;
  kept = {digest.value(), nullptr};
  const bool volume = scene.node(geometry).type->read_as == NodeKind::volume_emitter;
  MeshOptions options;
  options.segments = kSurfaceSegments;
  options.texture_coordinates = false;
  const Mesh mesh = volume ? mesh_of_volume(scene, geometry) : tessellate(scene, geometry, options);
  if (!afford(mesh.indices.size())) return nullptr;
  auto tree = std::make_shared<const SurfaceTree>(mesh);
  if (!tree->empty()) kept.object = std::move(tree);
  return kept.object;
}

std::shared_ptr<const ParticleLines> ParticleNodes::lines(const SceneGraph& scene, NodeId emitter,
                                                          const Afford& afford) {
  ValueDigest digest;
  digest.add(scene, emitter, kDigestDepth);
  Kept<ParticleLines>& kept = lines_[emitter.index];
  if (kept.digest == digest.value()) return kept.object;
  kept = {digest.value(), nullptr};
  const std::vector<glm::vec3> points = points_of_emitter(scene, emitter);
  if (!afford(points.size() + particle_field<MFInt32>(scene, emitter, "coordIndex", {}).size())) return nullptr;
  auto made = std::make_shared<ParticleLines>();
  double length = 0;
  for_runs(scene, emitter, points, [&](const std::vector<std::uint32_t>& run) {
    for (std::size_t i = 0; i + 1 < run.size(); ++i) {
      const glm::vec3 from = points[run[i]], to = points[run[i + 1]];
      const float one = glm::distance(from, to);
      if (!(one > 0) || !std::isfinite(one)) continue;
      length += double{one};
      made->segments.push_back({from, to, length});
    }
  });
  if (!made->segments.empty()) kept.object = std::move(made);
  return kept.object;
}

}  // namespace gs::vrml
