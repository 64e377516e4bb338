#include "render/collection/render_scene.h"
#include "tests/render/drawing.h"
#include "tests/render/x3d_scene.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

// Tests of ParticleSystems in render lists and pictures (X3D clause 40).
namespace gs::render::particles_test {

using namespace gs::render::testing;

namespace {

/// Running world with a RenderScene that follows it.
class ParticlePicture {
 public:
  explicit ParticlePicture(const std::string& body, const glm::dvec3& viewer = {0, 0, 10})
      : scene_(x3d_scene(body)), execution_(*scene_), render_(*scene_, images_, geometries_, meshes_), viewer_(viewer) {
    execution_.start(1000);
    (void)execution_.changes().take();
    render_.gather({}, viewer_);
  }
  bool show(double time) {
    execution_.step(1000 + time);
    const auto changes = execution_.changes().take();
    forget_changed(meshes_, changes);
    return render_.update(changes, {}, viewer_);
  }
  [[nodiscard]] const RenderList& list() const { return render_.list(); }
  [[nodiscard]] std::size_t gathered() const { return render_.gathered(); }

 private:
  std::unique_ptr<vrml::SceneGraph> scene_;
  vrml::Execution execution_;
  Images images_;
  Geometries geometries_;
  MeshCache meshes_;
  RenderScene render_;
  glm::dvec3 viewer_;
};

const std::string kRedSprites =
    "ParticleSystem { geometryType \"SPRITE\" particleSize 4 4 maxParticles 50 emitter PointEmitter { speed 0.1 }"
    " appearance Appearance { material UnlitMaterial { emissiveColor 1 0 0 } } }";

}  // namespace

TEST_CASE("draws the particles of a system without collecting the world again") {
  ParticlePicture picture(kRedSprites);
  Drawing drawing;
  REQUIRE(picture.list().items.size() == 1);
  const DrawItem& item = picture.list().items[0];
  CHECK(item.mesh->empty());
  CHECK_FALSE(item.touchable);
  CHECK_FALSE(item.collidable);
  CHECK_FALSE(picture.list().bounds.empty());
  CHECK(pixel(drawing.draw(picture.list()), 32, 32) == glm::vec3(0));
  CHECK(picture.show(2));
  CHECK_FALSE(item.mesh->empty());
  CHECK(pixel(drawing.draw(picture.list()), 32, 32).x > 0.99F);
  CHECK(pixel(drawing.draw(picture.list()), 32, 32).y == 0);
  CHECK(picture.gathered() == 1);
}

TEST_CASE("draws equal pictures of particles at equal times") {
  const std::string fire =
      "ParticleSystem { geometryType \"SPRITE\" particleSize 1 1 maxParticles 300 particleLifetime 3"
      " emitter ConeEmitter { speed 1 angle 0.5 mass 1 surfaceArea 1 } physics WindPhysicsModel { turbulence 0.5 speed "
      "1 }"
      " color ColorRGBA { color [ 1 1 0 0.5, 1 0 0 0 ] } colorKey [ 0 3 ] }";
  ParticlePicture often(fire), once(fire);
  for (double time = 0; time < 4; time += 0.11) (void)often.show(time);
  (void)often.show(4);
  (void)once.show(4);
  Drawing drawing;
  const Image a = drawing.draw(often.list()), b = drawing.draw(once.list());
  CHECK(a.pixels == b.pixels);
  CHECK(often.list().items[0].mesh->translucent);
  CHECK(pixel(a, 32, 30).x > 0.5F);  // fire at the centre
  CHECK(pixel(a, 2, 60) == glm::vec3(0));
}

TEST_CASE("draws copies of a geometry as particles") {
  ParticlePicture picture(
      "ParticleSystem { geometryType \"GEOMETRY\" maxParticles 20 geometry Sphere { radius 2 }"
      " emitter PointEmitter { speed 0 } appearance Appearance { material Material { emissiveColor 0 0 1 } } }");
  CHECK(picture.show(3));
  Drawing drawing;
  CHECK(pixel(drawing.draw(picture.list()), 32, 32).z > 0.9F);
  CHECK(drawing.statistics.draw_calls == 1);
}

TEST_CASE("shows nothing of hidden particle systems") {
  ParticlePicture picture("Switch { whichChoice -1 children [ " + kRedSprites + " ] }");
  CHECK_FALSE(picture.show(2));
  CHECK(picture.list().items.empty());
}

}  // namespace gs::render::particles_test
