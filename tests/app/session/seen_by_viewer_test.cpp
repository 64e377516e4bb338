// Tests of content that depends on the viewer's orientation: screen-facing Billboards and HUDs.
#include "app/loading/world_loader.h"
#include "app/simulation/simulation.h"
#include "tests/app/pairs.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <optional>
#include <string>
#include <utility>

namespace gs::app::seen_by_viewer_test {
using namespace pairs;

namespace {

/// Pictures of a world from the first Viewpoint, from a named Viewpoint, or from another position.
class Eye {
 public:
  render::Image seen(const std::string& text, double seconds = 0.1, const std::string& viewpoint = {},
                     const std::optional<render::Camera>& from = {}) {
    const ScratchFolder folder;
    LoadedWorld world = load_world(folder.write("main.wrl", "#VRML V2.0 utf8\n" + text));
    REQUIRE(world.scene);
    CHECK(world.diagnostics.errors() == 0);
    Simulation simulation(std::move(world), {64, 64});
    if (!viewpoint.empty()) REQUIRE_FALSE(simulation.begin_at(viewpoint));
    simulation.run(seconds);
    const render::Camera camera = from ? *from : simulation.camera();
    simulation.stand_at(camera);
    const render::RenderList& list = simulation.look_from(camera);
    drawing_.options.headlight = list.navigation.headlight;
    return drawing_.draw(list, camera);
  }

 private:
  render::testing::Drawing drawing_;
};

std::array<int, 3> pixel_at(const render::Image& image, std::size_t x, std::size_t y) {
  const std::uint8_t* pixel = image.pixels.data() + (y * image.width + x) * image.components;
  return {pixel[0], pixel[1], pixel[2]};
}

// Sign with different halves, so that a mirrored picture differs.
const std::string kFlag =
    "Shape { geometry IndexedFaceSet { solid FALSE coord Coordinate { point [ -1 -1 0, 1 -1 0, 1 1 0, -0.2 0.3 0 ] } "
    "coordIndex [ 0 1 2 3 ] } }";

std::string shape_of(const std::string& color, const std::string& geometry) {
  return "Shape { appearance Appearance { material Material { diffuseColor 0 0 0 emissiveColor " + color +
         " } } geometry " + geometry + " } ";
}

TEST_CASE("rolls a screen-facing Billboard with the viewer (VRML97 6.6)") {
  Eye eye;
  // "the local Y-axis of the Billboard node is parallel to the Y-axis of the viewer"
  for (const char* roll : {"0.6", "-1.9"}) {
    const std::string turn = std::string("rotation 0 0 1 ") + roll;
    const std::string viewpoint = std::string("Viewpoint { position 0 0 5 orientation 0 0 1 ") + roll + " } ";
    const render::Image billboard = eye.seen(viewpoint + "Billboard { axisOfRotation 0 0 0 children " + kFlag + " }");
    const render::Image by_hand = eye.seen(viewpoint + "Transform { " + turn + " children " + kFlag + " }");
    const render::Image unrolled = eye.seen(viewpoint + kFlag);
    CHECK(compare_pictures(billboard, by_hand).pixels == 0);
    CHECK(compare_pictures(unrolled, by_hand).pixels > 100);
    // Rotated groups above it change nothing.
    const render::Image below = eye.seen(viewpoint + "Transform { rotation 0.3 0.5 0.2 1.1 children " +
                                         "Billboard { axisOfRotation 0 0 0 children " + kFlag + " } }");
    CHECK(compare_pictures(below, by_hand).pixels < 8);
  }
}

TEST_CASE("never rolls a Billboard about any other axis (VRML97 6.6)") {
  Eye eye;
  const std::string viewpoint = "Viewpoint { position 0 0 5 orientation 0 0 1 0.6 } ";
  CHECK(compare_pictures(eye.seen(viewpoint + "Billboard { children " + kFlag + " }"), eye.seen(viewpoint + kFlag))
            .pixels == 0);
}

TEST_CASE("draws a HUD over nearer objects, and moves it with the viewer") {
  Eye eye;
  const std::string wall = "Transform { translation 3 0 3 children " + shape_of("0 0 1", "Box { size 40 40 1 }") + "} ";
  const std::string sign =
      "HUD { children Transform { translation 0 0 -20 children " + shape_of("1 0 0", "Box { size 4 4 1 }") + "} } ";
  const std::string viewpoint = "NavigationInfo { headlight FALSE } Viewpoint { position 3 0 10 } ";
  for (const std::string& both : {wall + sign, sign + wall}) {
    const render::Image image = eye.seen(viewpoint + both);
    CHECK(pixel_at(image, 32, 32) == std::array<int, 3>{255, 0, 0});
    CHECK(pixel_at(image, 8, 8) == std::array<int, 3>{0, 0, 255});
  }
  // The orientation is correct from any start, in the first picture.
  const std::string other =
      "Transform { translation 50 0 7 children Viewpoint { orientation 0 1 0 2 description \"other\" } } ";
  CHECK(pixel_at(eye.seen(viewpoint + wall + sign + other, 0, "other"), 32, 32) == std::array<int, 3>{255, 0, 0});
  CHECK(pixel_at(eye.seen(viewpoint + wall + other, 0, "other"), 32, 32) == std::array<int, 3>{0, 0, 0});
  render::Camera camera;
  camera.world_from_camera = glm::rotate(glm::translate(glm::dmat4(1), {-8, 30, 4}), 2.5, glm::dvec3(0.3, 1, 0.2));
  CHECK(pixel_at(eye.seen(viewpoint + wall + sign, 0, {}, camera), 32, 32) == std::array<int, 3>{255, 0, 0});
  // The orientation is also correct without a Viewpoint, when the camera frames the scene.
  CHECK(pixel_at(eye.seen("NavigationInfo { headlight FALSE } " + wall + sign, 0), 32, 32) ==
        std::array<int, 3>{255, 0, 0});
  // Of two HUDs the nearer one hides the farther one.
  const std::string two =
      "HUD { children [ Transform { translation 0 0 -5 children " + shape_of("0 1 0", "Box { size 0.4 0.4 0.1 }") +
      "} Transform { translation 0 0 -20 children " + shape_of("1 0 0", "Box { size 4 4 1 }") + "} ] } ";
  const render::Image image = eye.seen(viewpoint + wall + two);
  CHECK(pixel_at(image, 32, 32) == std::array<int, 3>{0, 255, 0});
  CHECK(pixel_at(image, 27, 32) == std::array<int, 3>{255, 0, 0});
}

}  // namespace
}  // namespace gs::app::seen_by_viewer_test
