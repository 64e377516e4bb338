#include "render/collection/render_scene.h"
#include "tests/render/drawing.h"
#include "tests/render/volume_rendering/volume_texts.h"
#include "tests/render/x3d_scene.h"
#include "vrml/events/execution.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

// Tests of volume data nodes in render lists (X3D clause 41).
namespace gs::render::volume_looks_test {

using namespace gs::render::testing;

namespace {

using Kind = VolumeStep::Kind;

const std::string kVoxels = "voxels " + pixel_volume({2, 2, 2}, [](double, double, double) { return 128.0; }) + " ";

VolumeLook look(const std::string& node, const std::string& fields) {
  const RenderList list = x3d_list(node + " { " + kVoxels + fields + " }");
  REQUIRE(list.items.size() == 1);
  REQUIRE(list.items[0].volume);
  return *list.items[0].volume;
}

/// Returns the only step of a VolumeData with this style.
VolumeStep step(const std::string& style) {
  const VolumeLook made = look("VolumeData", "renderStyle " + style);
  REQUIRE(made.chains.size() == 1);
  REQUIRE(made.chains[0].steps.size() == 1);
  return made.chains[0].steps[0];
}

}  // namespace

TEST_CASE("collects the default values of each volume style (X3D 41.4)") {
  CHECK(look("VolumeData", "").chains.empty());
  CHECK(step("OpacityMapVolumeStyle { }").kind == Kind::opacity_map);
  CHECK(step("BoundaryEnhancementVolumeStyle { }").values == std::vector{glm::vec4(0.2f, 0.9f, 2, 0)});
  CHECK(step("SilhouetteEnhancementVolumeStyle { }").values == std::vector{glm::vec4(1, 0, 0.5f, 0)});
  const VolumeStep edge = step("EdgeEnhancementVolumeStyle { }");
  CHECK(edge.values[0] == glm::vec4(0, 0, 0, 1));
  CHECK(edge.values[1].x == Approx(std::cos(0.4)));
  CHECK(step("ToneMappedVolumeStyle { }").values == std::vector{glm::vec4(1, 1, 0, 0), glm::vec4(0, 0, 1, 0)});
  const VolumeStep shaded = step("ShadedVolumeStyle { }");
  CHECK_FALSE(shaded.lit);
  CHECK_FALSE(shaded.has_material);
  CHECK(shaded.scatters);
  const VolumeLook projection = look("VolumeData", "renderStyle ProjectionVolumeStyle { }");
  CHECK(projection.chains.at(0).projected);
  CHECK(projection.projection == VolumeLook::Projection::maximum);
}

TEST_CASE("divides the angles of a CartoonVolumeStyle into steps of colours in HSV (X3D 41.4.3)") {
  const auto grey = [](float g) { return glm::vec3(g); };
  const auto colors = step("CartoonVolumeStyle { }").values;
  REQUIRE(colors.size() == 4);
  CHECK(glm::vec3(colors[0]) == grey(1));
  CHECK(colors[1].r == Approx(0.625));
  CHECK(colors[2].g == Approx(0.375));
  CHECK(glm::vec3(colors[3]) == grey(0));
  CHECK(step("CartoonVolumeStyle { colorSteps 1 parallelColor 1 0 0 1 }").values == std::vector{glm::vec4(1)});
}

TEST_CASE("composes volume styles in order, without the disabled ones (X3D 41.4.4)") {
  const VolumeLook made = look("VolumeData",
                               "renderStyle ComposedVolumeStyle { renderStyle [ EdgeEnhancementVolumeStyle { }"
                               " ToneMappedVolumeStyle { enabled FALSE } ComposedVolumeStyle { renderStyle"
                               " SilhouetteEnhancementVolumeStyle { } } ] }");
  REQUIRE(made.chains.size() == 1);
  REQUIRE(made.chains[0].steps.size() == 2);
  CHECK(made.chains[0].steps[0].kind == Kind::edge);
  CHECK(made.chains[0].steps[1].kind == Kind::silhouette);
  CHECK_FALSE(look("VolumeData", "renderStyle ProjectionVolumeStyle { enabled FALSE }").chains.at(0).projected);
}

TEST_CASE("gives isosurfaces their styles, also those at multiples of contourStepSize (X3D 41.4.6)") {
  const VolumeLook several = look("IsoSurfaceVolumeData",
                                  "surfaceValues [ 0.6 0.2 0.4 ] contourStepSize 0.1 renderStyle"
                                  " [ EdgeEnhancementVolumeStyle { } ToneMappedVolumeStyle { } ]");
  CHECK(several.surfaces == std::vector{0.2f, 0.4f, 0.6f});
  CHECK(several.surface_chains == std::vector<std::uint32_t>{1, 1, 0});
  const VolumeLook contours = look("IsoSurfaceVolumeData",
                                   "surfaceValues 0.5 contourStepSize 0.2 surfaceTolerance 0.01 renderStyle"
                                   " [ EdgeEnhancementVolumeStyle { } ToneMappedVolumeStyle { }"
                                   " SilhouetteEnhancementVolumeStyle { } ]");
  REQUIRE(contours.surfaces.size() == 5);
  CHECK(contours.surfaces[0] == Approx(0.1f));
  CHECK(contours.surfaces[4] == Approx(0.9f));
  CHECK(contours.surface_chains == std::vector<std::uint32_t>{1, 2, 0, 2, 2});
  CHECK(contours.least_gradient == Approx(0.01f));
}

TEST_CASE("includes volumes in the bounds of the world, touchable but without collision") {
  const RenderList list = x3d_list("Transform { translation 5 0 0 children VolumeData { " + kVoxels +
                                   "dimensions 2 4 6 } } VolumeData { visible FALSE " + kVoxels + " }");
  REQUIRE(list.items.size() == 1);
  CHECK(list.bounds.lower == glm::dvec3(4, -2, -3));
  CHECK(list.bounds.upper == glm::dvec3(6, 2, 3));
  CHECK(list.items[0].touchable);
  CHECK_FALSE(list.items[0].collidable);
}

TEST_CASE("reports volumes that cannot be drawn, each reason once") {
  const auto reports = [](const std::string& body) {
    const RenderList list = x3d_list(body);
    CHECK(list.items.empty());
    REQUIRE(list.limit_reports.size() == 1);
    return list.limit_reports[0].why;
  };
  CHECK(reports("VolumeData { dimensions 1 0 1 " + kVoxels + " } VolumeData { dimensions -1 1 1 " + kVoxels + " }") ==
        "the dimensions of a volume: expected numbers above 0");
  CHECK(reports("VolumeData { }") == "a volume without voxels: expected a 3D texture");
  CHECK(reports("VolumeData { voxels PixelTexture3D { image [ 1 100 100 100 7 ] } }") ==
        "a volume with an invalid image: expected components, width, height, depth, and a number per voxel");
  std::string styles;
  for (int i = 0; i < 40; ++i) styles += " EdgeEnhancementVolumeStyle { }";
  const RenderList many =
      x3d_list("VolumeData { " + kVoxels + "renderStyle ComposedVolumeStyle { renderStyle [" + styles + " ] } }");
  REQUIRE(many.items.size() == 1);
  CHECK(many.items[0].volume->chains.at(0).steps.size() == VolumeLook::kMaxSteps);
  CHECK(many.limit_reports.size() == 1);
}

TEST_CASE("follows events to volumes and their styles without collecting the world again") {
  const auto scene = x3d_scene(
      "DEF T TimeSensor { loop TRUE cycleInterval 10 } DEF S ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] }"
      " DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 1 1 1 3 1 1 ] }"
      " DEF V VolumeData { " +
      kVoxels +
      "renderStyle DEF E SilhouetteEnhancementVolumeStyle { } }"
      " ROUTE T.fraction_changed TO S.set_fraction ROUTE T.fraction_changed TO P.set_fraction"
      " ROUTE S.value_changed TO E.set_silhouetteRetainedOpacity ROUTE P.value_changed TO V.set_dimensions");
  vrml::Execution execution(*scene);
  Images images;
  Geometries geometries;
  MeshCache meshes;
  RenderScene render(*scene, images, geometries, meshes);
  execution.start(1000);
  (void)execution.changes().take();
  render.gather({}, {0, 0, 10});
  execution.step(1005);
  const auto changes = execution.changes().take();
  forget_changed(meshes, changes);
  CHECK(render.update(changes, {}, {0, 0, 10}));
  CHECK(render.gathered() == 1);
  const RenderList& list = render.list();
  REQUIRE(list.items.size() == 1);
  CHECK(list.items[0].volume->chains.at(0).steps.at(0).values[0].x == Approx(0.5));
  CHECK(list.items[0].volume->dimensions.x == Approx(2));
  CHECK(list.bounds.upper.x == Approx(1));
}

}  // namespace gs::render::volume_looks_test
