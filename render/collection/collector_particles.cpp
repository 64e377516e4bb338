// Part of Collector for ParticleSystems (X3D clause 40).
#include "render/collection/collector.h"
#include "vrml/behaviours/particles/particle_simulation.h"
#include "vrml/scene/values/transformation.h"

#include <algorithm>
#include <string>
#include <utility>

namespace gs::render {
namespace {

// Above this number of triangles, copies of a primitive are coarser.
constexpr std::size_t kManyParticleTriangles = std::size_t{1} << 17;

}  // namespace

bool renew_particles(DrawItem& item, RenderSources::Item& source, RenderSources::Particles& particles,
                     const vrml::SceneGraph& scene, vrml::NodeId system, const glm::dmat4& world,
                     const glm::dvec3& viewer, const glm::dvec3& up) {
  const vrml::ParticleSimulation* const simulation = scene.particles().of(system);
  const double moment = simulation ? simulation->moment() : 0;
  glm::dvec3 local_viewer = particles.view.viewer, local_up = particles.view.up;
  if (particles.sprites) {
    local_viewer = vrml::viewer_in_local(viewer, world);
    local_up = vrml::direction_in_local(up, world);
  }
  if (item.mesh && simulation == particles.simulation && moment == particles.moment &&
      local_viewer == particles.view.viewer && local_up == particles.view.up)
    return false;
  if (simulation != particles.simulation) source.region.add(vrml::particle_region(scene, system));
  particles.simulation = simulation;
  particles.moment = moment;
  particles.view.viewer = local_viewer;
  particles.view.up = local_up;
  const bool was_empty = item.mesh && item.mesh->empty();
  auto mesh = std::make_shared<vrml::Mesh>(vrml::particle_mesh(scene, system, particles.view));
  if (!particles.share) particles.share = std::make_shared<Share>(scene.budget(), Resource::meshes);
  const std::uint64_t cost = mesh->cost();
  particles.share->shrink_to(cost);
  if (cost > particles.share->amount() && !particles.share->grow(cost - particles.share->amount())) *mesh = {};
  source.region.add(mesh->bounds);
  if (was_empty && mesh->empty()) return false;
  item.mesh = std::move(mesh);
  return true;
}

void Collector::add_particles(const Frame& parent, vrml::NodeId id, const NodeView& system) {
  DrawItem item;
  RenderSources::Item source;
  RenderSources::Particles particles;
  const vrml::SceneGraph& scene = *parent.scene;
  resources_.apply_appearance(item, scene, system);
  source.appearance = resources_.appearance_nodes(scene, system);
  const vrml::ParticleShape shape = vrml::particle_shape(scene, id);
  particles.sprites = shape == vrml::ParticleShape::sprite;
  particles.view.texture_coordinates = source.appearance.need_coordinates();
  const vrml::ParticleSimulation* const simulation = scene.particles().of(id);
  const std::size_t most = simulation ? simulation->settings().most : 1;
  const vrml::NodeId geometry = shape == vrml::ParticleShape::geometry ? geometry_of(scene, system) : vrml::NodeId{};
  if (geometry) {
    source.geometry = &scene.node(geometry);
    if (const auto scale = vrml::scale_of_primitive(scene, geometry)) {
      particles.view.scale = *scale;
      std::size_t fineness = 1;
      do {
        particles.view.geometry = resources_.primitive(scene, geometry, fineness);
      } while (particles.view.geometry->indices.size() / 3 * most > kManyParticleTriangles &&
               ++fineness <= ShapeResources::kCoarsestPrimitive);
    } else {
      particles.view.geometry = resources_.mesh_of(scene, geometry, source.appearance.need_coordinates());
    }
  }
  if (scene.get<vrml::SFInt32>(id, "maxParticles") > static_cast<std::int64_t>(vrml::ParticleSettings::kMaxParticles))
    resources_.report_limit("more particles than the " + std::to_string(vrml::ParticleSettings::kMaxParticles) +
                                " that one system may have",
                            scene, id);
  const std::size_t copied = particles.view.geometry ? particles.view.geometry->indices.size() / 3 : 2;
  if (!fits_float(parent.world_from_local) ||
      !room_.take_item(list_, std::min(most * copied, vrml::kMaxParticleIndices / 3), scene, id))
    return;
  (void)renew_particles(item, source, particles, scene, id, parent.world_from_local, viewer_, sight_.orientation[1]);
  item.touchable = false;
  particles.item = static_cast<std::uint32_t>(list_.items.size());
  add_item(parent, id, geometry, std::move(item), source, parent.world_from_local);
  if (sources_) sources_->particles.push_back(std::move(particles));
}

}  // namespace gs::render
