#include "vrml/behaviours/particles/particle_mesh.h"
#include "vrml/behaviours/particles/particle_simulation.h"

#include "tests/vrml/events/trace.h"

#include <glm/glm.hpp>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::vrml::traces {
namespace {

using EmitterKind = ParticleEmitter::Kind;

ParticleSettings particle_settings(EmitterKind kind) {
  ParticleSettings settings;
  settings.emitter.kind = kind;
  settings.emitter.speed = 2;
  settings.emitter.direction = {0, 1, 0};
  settings.most = 200;
  settings.lifetime = 4;
  settings.lifetime_variation = 0.25F;
  settings.size = {0.5F, 1};
  return settings;
}

std::vector<ShownParticle> particles_at(ParticleSimulation& simulation, double time) {
  simulation.pass_to(time);
  const auto shown = simulation.shown();
  return {shown.begin(), shown.end()};
}

std::vector<ShownParticle> particles_at(const ParticleSettings& settings, double time) {
  ParticleSimulation simulation(7, 0, settings);
  return particles_at(simulation, time);
}

bool same_particles(const std::vector<ShownParticle>& a, const std::vector<ShownParticle>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].position != b[i].position || a[i].velocity != b[i].velocity || a[i].lifetime != b[i].lifetime)
      return false;
  return true;
}

// Closed cube with corners at -1 and 1.
std::shared_ptr<const SurfaceTree> cube_surface(bool solid = true) {
  SceneGraph scene("cube.wrl");
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\nShape { geometry Box { } }", scene, diagnostics);
  Mesh mesh = tessellate(scene, scene.resolve(scene.get<SFNode>(scene.roots()[0], "geometry")));
  mesh.solid = solid;
  return std::make_shared<const SurfaceTree>(mesh);
}

// World with a ParticleSystem called P as its only node.
struct ParticleWorld : World {
  explicit ParticleWorld(const std::string& fields, const std::string& rest = {})
      : World("DEF P ParticleSystem { " + fields + " } " + rest, {}, Language::x3d) {}
  [[nodiscard]] Mesh mesh(const ParticleView& view = {}) { return particle_mesh(scene(), scene().roots()[0], view); }
};

}  // namespace

TEST_CASE("creates particles up to maxParticles with varied lifetimes") {
  const ParticleSettings settings = particle_settings(EmitterKind::point);
  CHECK(particles_at(settings, 0).empty());
  CHECK(particles_at(settings, 2).size() == 100);
  const auto full = particles_at(settings, 20);
  CHECK(full.size() > 180);
  CHECK(full.size() <= 200);
  for (const ShownParticle& one : full) {
    CHECK(one.lifetime >= 3);
    CHECK(one.lifetime <= 5);
    CHECK(one.age < one.lifetime);
  }
  ParticleSettings none = settings;
  none.lifetime = 0;
  CHECK(particles_at(none, 5).empty());
  none = settings;
  none.most = 0;
  CHECK(particles_at(none, 5).empty());
}

TEST_CASE("shows equal particles at equal times, independent of earlier frames") {
  ParticleSettings settings = particle_settings(EmitterKind::cone);
  settings.emitter.angle = 1;
  settings.emitter.surface_area = 1;
  settings.force = {0, -1, 0};
  settings.winds.push_back({{1, 0, 0}, 0.5F, 1, 0.5F});
  settings.bounds.push_back(cube_surface());
  ParticleSimulation often(3, 100, settings), once(3, 100, settings), other(4, 100, settings);
  for (double time = 100; time < 140; time += 0.37) (void)particles_at(often, time);
  const auto wanted = particles_at(often, 140);
  CHECK(wanted.size() > 100);
  CHECK(same_particles(particles_at(once, 140), wanted));
  CHECK_FALSE(same_particles(particles_at(other, 140), wanted));
}

TEST_CASE("emits particles from points and cones") {
  ParticleSettings settings = particle_settings(EmitterKind::point);
  settings.emitter.position = {1, 2, 3};
  settings.emitter.variation = 0.5F;
  for (const ShownParticle& one : particles_at(settings, 6)) {
    const glm::vec3 way = one.position - settings.emitter.position;
    CHECK(std::abs(way.x) + std::abs(way.z) < 1e-4F);
    CHECK(way.y == Approx(one.velocity.y * one.age).margin(1e-4));
    CHECK(one.velocity.y >= 1);
    CHECK(one.velocity.y <= 3);
  }
  settings.emitter.kind = EmitterKind::cone;
  settings.emitter.angle = 0.5F;
  float widest = 0;
  for (const ShownParticle& one : particles_at(settings, 6))
    widest = std::max(widest, std::acos(std::min(glm::normalize(one.velocity).y, 1.0F)));
  CHECK(widest < 0.501F);
  CHECK(widest > 0.4F);
  // Without a direction, particles fly in all directions.
  settings.emitter.direction = glm::vec3(0);
  glm::vec3 low(0), high(0);
  for (const ShownParticle& one : particles_at(settings, 6)) {
    low = glm::min(low, one.velocity);
    high = glm::max(high, one.velocity);
  }
  for (int i = 0; i < 3; ++i) CHECK((low[i] < -1 && high[i] > 1));
}

TEST_CASE("emits all particles of an explosion at once") {
  const ParticleSettings settings = particle_settings(EmitterKind::explosion);
  ParticleSimulation simulation(1, 0, settings);
  const auto early = particles_at(simulation, 1);
  CHECK(early.size() == 200);
  for (const ShownParticle& one : early) {
    CHECK(one.age == Approx(1));
    CHECK(glm::length(one.position) == Approx(2).margin(1e-3));
  }
  CHECK(simulation.is_busy());
  CHECK(particles_at(simulation, 5.1).empty());
  CHECK_FALSE(simulation.is_busy());
}

TEST_CASE("emits particles along polylines") {
  ParticleSettings settings = particle_settings(EmitterKind::polyline);
  auto lines = std::make_shared<ParticleLines>();
  lines->segments = {{{0, 0, 0}, {3, 0, 0}, 3}, {{3, 0, 0}, {3, 0, 1}, 4}};
  settings.emitter.lines = lines;
  settings.emitter.speed = 0;
  std::size_t first = 0, second = 0;
  for (const ShownParticle& one : particles_at(settings, 10)) {
    const bool on_first = one.position.z == 0 && one.position.x >= 0 && one.position.x <= 3;
    const bool on_second = one.position.x == 3 && one.position.z > 0 && one.position.z <= 1;
    CHECK((on_first || on_second));
    ++(on_second ? second : first);
  }
  CHECK(first > 2 * second);
  CHECK(second > 20);
}

TEST_CASE("emits particles from surfaces along their normals") {
  ParticleSettings settings = particle_settings(EmitterKind::surface);
  settings.emitter.surface = cube_surface();
  const auto out_of = [](const ShownParticle& one) {
    const glm::vec3 far = glm::abs(one.position);
    return std::max(far.x, std::max(far.y, far.z)) > 1;
  };
  for (const ShownParticle& one : particles_at(settings, 0.4)) CHECK(out_of(one));
  settings.emitter.surface = cube_surface(false);
  std::size_t inside = 0;
  const auto both = particles_at(settings, 0.4);
  for (const ShownParticle& one : both) inside += out_of(one) ? 0 : 1;
  CHECK(inside > 0);
  CHECK(inside < both.size());
}

TEST_CASE("emits particles inside of volumes") {
  ParticleSettings settings = particle_settings(EmitterKind::volume);
  settings.emitter.surface = cube_surface();
  settings.emitter.speed = 0;
  glm::vec3 low(0), high(0);
  for (const ShownParticle& one : particles_at(settings, 10)) {
    low = glm::min(low, one.position);
    high = glm::max(high, one.position);
  }
  for (int i = 0; i < 3; ++i) {
    CHECK(low[i] >= -1);
    CHECK(low[i] < -0.8F);
    CHECK(high[i] <= 1);
    CHECK(high[i] > 0.8F);
  }
}

TEST_CASE("accelerates particles by forces and winds") {
  ParticleSettings settings = particle_settings(EmitterKind::point);
  settings.emitter.mass = 2;
  settings.force = {0, 0, -6};
  for (const ShownParticle& one : particles_at(settings, 3)) {
    CHECK(one.position.z == Approx(-1.5 * one.age * one.age).margin(0.01));
    CHECK(one.position.y == Approx(2 * one.age).margin(0.01));
  }
  // A wind of 1 m/s has a pressure of 0.64615 newtons per square metre.
  settings.force = {0, 0, 0};
  settings.emitter.surface_area = 4;
  settings.winds.push_back({{1, 0, 0}, 1, 0, 0});
  for (const ShownParticle& one : particles_at(settings, 3))
    CHECK(one.position.x == Approx(0.64615 * one.age * one.age).margin(0.01));
  // Turbulence spreads the particles.
  settings.winds[0].turbulence = 0.5F;
  bool left = false, right = false;
  for (const ShownParticle& one : particles_at(settings, 3)) (one.position.z < 0 ? left : right) = true;
  CHECK((left && right));
}

TEST_CASE("reflects particles from bounding surfaces") {
  ParticleSettings settings = particle_settings(EmitterKind::cone);
  settings.emitter.angle = 3;
  settings.emitter.speed = 5;
  settings.bounds.push_back(cube_surface());
  const auto inside = particles_at(settings, 10);
  CHECK(inside.size() > 150);
  for (const ShownParticle& one : inside) {
    for (int i = 0; i < 3; ++i) CHECK(std::abs(one.position[i]) <= 1);
    CHECK(glm::length(one.velocity) == Approx(5));
  }
}

TEST_CASE("bounds the work of long lives, long pauses and many particles") {
  ParticleSettings settings = particle_settings(EmitterKind::point);
  settings.most = ParticleSettings::kMaxParticles;
  settings.lifetime = ParticleSettings::kShortestLife;
  CHECK(particles_at(settings, 1e9).size() <= settings.most);
  settings.lifetime = 60;
  CHECK(particles_at(settings, 1e6).size() > 90'000);
  settings.lifetime = ParticleSettings::kLongestLife;
  CHECK(particles_at(settings, 1e8).size() > 90'000);
}

TEST_CASE("sends isActive of a ParticleSystem when it starts and stops") {
  ParticleWorld world("emitter PointEmitter { speed 1 } particleLifetime 1");
  world.start();
  CHECK(world.take() == Lines{"0 P.isActive TRUE"});
  CHECK(world.take_at(1).empty());
  CHECK_FALSE(world.mesh().empty());
  world.send("P.enabled", false);
  CHECK(world.take("isActive") == Lines{"1 P.isActive FALSE"});
  CHECK(world.mesh().empty());
  world.step(2);
  world.send("P.enabled", true);
  CHECK(world.take("isActive") == Lines{"2 P.isActive TRUE"});
  CHECK(world.mesh().empty());
  world.step(2.5);
  CHECK_FALSE(world.mesh().empty());

  ParticleWorld without("particleLifetime 1");
  without.start();
  CHECK(without.take_at(1).empty());
}

TEST_CASE("keeps living particles after createParticles FALSE") {
  ParticleWorld world(
      "emitter DEF E PointEmitter { speed 1 } particleLifetime 2 geometryType \"POINT\" maxParticles 100");
  world.start();
  world.step(1);
  const std::size_t before = world.mesh().indices.size();
  CHECK(before > 40);
  world.send("P.createParticles", false);
  world.step(1.1);
  CHECK(world.mesh().indices.size() >= before);
  world.step(4);
  CHECK(world.mesh().empty());
  world.send("P.createParticles", true);
  world.step(5);
  CHECK_FALSE(world.mesh().empty());
}

TEST_CASE("gives particles the geometry of each geometryType") {
  const auto mesh_at = [](const std::string& fields, const ParticleView& view = {}) {
    ParticleWorld world(fields +
                        " emitter PointEmitter { speed 1 } maxParticles 10 lifetimeVariation 0 "
                        "particleLifetime 1 particleSize 0.2 0.4");
    world.start();
    world.step(0.55);
    return world.mesh(view);
  };
  const Mesh quads = mesh_at("");
  CHECK(quads.primitive == Mesh::Primitive::triangles);
  CHECK(quads.indices.size() == 6 * 6);
  CHECK(quads.bounds.lower.z == 0);
  CHECK(quads.bounds.upper.x == Approx(0.1));
  CHECK_FALSE(quads.solid);
  CHECK(mesh_at("geometryType \"TRIANGLE\"").positions == quads.positions);
  const Mesh points = mesh_at("geometryType \"POINT\"");
  CHECK(points.primitive == Mesh::Primitive::points);
  CHECK(points.indices.size() == 6);
  const Mesh lines = mesh_at("geometryType \"LINE\"");
  CHECK(lines.primitive == Mesh::Primitive::lines);
  CHECK(glm::distance(lines.positions[0], lines.positions[1]) == Approx(0.4));
  CHECK(lines.bounds.upper.x == 0);
  ParticleView view;
  CHECK(mesh_at("geometryType \"GEOMETRY\"", view).empty());
  view.geometry = std::make_shared<const Mesh>(quads);
  CHECK(mesh_at("geometryType \"GEOMETRY\"", view).indices.size() == 6 * quads.indices.size());
}

TEST_CASE("limits the copies of geometries with many unused points") {
  ParticleWorld world("geometryType \"GEOMETRY\" emitter ExplosionEmitter { speed 1 } maxParticles 100000");
  world.start();
  world.step(1);
  Mesh geometry;
  geometry.positions.resize(kMaxParticleIndices / 4);
  geometry.indices = {0, 1, 2};
  ParticleView view;
  view.geometry = std::make_shared<const Mesh>(std::move(geometry));
  CHECK(world.mesh(view).indices.size() == 3 * 4);
}

TEST_CASE("turns sprites to the viewer") {
  ParticleWorld world("geometryType \"SPRITE\" emitter PointEmitter { speed 0 } particleSize 1 1 maxParticles 1");
  world.start();
  world.step(1);
  ParticleView view;
  view.viewer = {10, 0, 0};
  const Mesh mesh = world.mesh(view);
  REQUIRE(mesh.positions.size() == 4);
  CHECK(mesh.bounds.size().x == Approx(0).margin(1e-6));
  CHECK(mesh.bounds.size().y == Approx(1));
  CHECK(mesh.bounds.size().z == Approx(1));
}

TEST_CASE("changes colours and texture coordinates over the life of a particle") {
  const auto mesh_at = [](const std::string& fields, double time) {
    ParticleWorld world("emitter PointEmitter { } maxParticles 1 lifetimeVariation 0 particleLifetime 10 " + fields);
    world.start();
    world.step(time);
    ParticleView view;
    view.texture_coordinates = true;
    return world.mesh(view);
  };
  const std::string colors = "color ColorRGBA { color [ 1 0 0 1, 0 1 0 0 ] } ";
  // Seconds.
  Mesh mesh = mesh_at(colors + "colorKey [ 0 4 ]", 2);
  REQUIRE(mesh.colors.size() == 4);
  CHECK(mesh.colors[0].r == Approx(1).margin(0.02));
  CHECK(mesh.colors[0].g == Approx(1).margin(0.02));  // yellow is between red and green in HSV space
  CHECK(mesh.opacities[0] == Approx(0.5).margin(0.01));
  CHECK(mesh.translucent);
  // Fractions of the lifetime, and the names of X3D 3.
  mesh = mesh_at("colorRamp Color { color [ 1 0 0, 0 0 1 ] } colorKey [ 0 1 ]", 9.99);
  CHECK(mesh.colors[0].b == Approx(1).margin(0.02));
  CHECK(mesh.opacities.empty());
  const std::string coordinates =
      "texCoordRamp TextureCoordinate { point [ 0 0, 0.5 0, 0.5 1, 0 1, 0.5 0, 1 0, 1 1, 0.5 1 ] } texCoordKey [ 0 5 ]";
  CHECK(mesh_at(coordinates, 4).texture_coordinates[1] == glm::vec2(0.5, 0));
  CHECK(mesh_at(coordinates, 6).texture_coordinates[1] == glm::vec2(1, 0));
  CHECK(mesh_at("", 6).texture_coordinates[1] == glm::vec2(1, 0));
}

TEST_CASE("follows events of emitters and physics models") {
  ParticleWorld world(
      "emitter DEF E PointEmitter { on FALSE direction 0 1 0 speed 1 } physics DEF F ForcePhysicsModel { enabled FALSE "
      "} "
      "geometryType \"POINT\" particleLifetime 1");
  world.start();
  world.step(3);
  CHECK(world.mesh().empty());
  world.send("E.on", true);
  for (double time = 3; time < 4; time += 0.02) world.step(time);
  CHECK_FALSE(world.mesh().empty());
  CHECK(world.mesh().bounds.lower.y >= 0);
  world.send("F.enabled", true);
  for (double time = 4; time < 5; time += 0.02) world.step(time);
  CHECK(world.mesh().bounds.lower.y < -1);
}

TEST_CASE("accepts hostile values of particle systems") {
  for (const std::string fields :
       {"maxParticles 2147483647 particleLifetime 1e38", "maxParticles -1", "particleLifetime -1",
        "particleLifetime 1e-38 maxParticles 100000", "lifetimeVariation 1e38", "particleSize -1 1e38"}) {
    INFO(fields);
    ParticleWorld world(fields +
                        " emitter PointEmitter { speed 1e38 mass 1e-38 surfaceArea 1e38 position 1e38 -1e38 0 }"
                        " physics [ WindPhysicsModel { speed 1e38 gustiness 1e38 turbulence 1 }"
                        " ForcePhysicsModel { force 1e38 1e38 1e38 } BoundedPhysicsModel { geometry Sphere { } } ]");
    world.start();
    world.step(1);
    world.step(1000);
    const Mesh mesh = world.mesh();
    for (const glm::vec3& position : mesh.positions) REQUIRE(std::isfinite(glm::dot(position, glm::vec3(1e-20F))));
  }
}

}  // namespace gs::vrml::traces
