// Tests of views of objects with other up axes than VRML97's, and of parallel projection.
#include "app/session/viewports/view.h"

#include "app/loading/world_loader.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <memory>
#include <string>
#include <utility>

namespace gs::app::view_style_test {
namespace {

constexpr glm::vec2 kSize(800, 600);

bool close(const glm::vec3& a, const glm::vec3& b) { return glm::distance(a, b) < 1e-3f; }

std::shared_ptr<Document> standing(const std::string& body, UpRule up) {
  LoadedWorld world = world_of(body);
  world.up = up;
  return make_document(std::move(world));
}

/// Reports whether a view is level and slightly from above.
bool level(const Pose& pose, const glm::vec3& up) {
  return std::abs(glm::dot(pose.right(), up)) < 1e-4f && glm::dot(pose.up(), up) > 0.8f &&
         glm::dot(pose.forward(), up) < -0.4f;
}

constexpr char kTower[] = "Shape { geometry Box { size 2 4 9 } }";
constexpr char kSeen[] = "Viewpoint { position 0 0 30 } Shape { geometry Box { size 2 4 9 } }";

}  // namespace

TEST_CASE("shows a file with another up axis upright at first, and walks with that up axis") {
  const View view = view_of(standing(kTower, UpRule::z), kSize, {});
  CHECK(view.navigation.up == glm::vec3(0, 0, 1));
  CHECK(level(view.home, {0, 0, 1}));
  Navigation walker = with_mode(view.navigation, NavigationMode::walk);
  NavigationInput ahead;
  ahead.move = {0, 0, 1};
  ahead.turn = {0.3f, 0};
  for (int i = 0; i < 30; ++i) walker = step(walker, ahead, 0.05f);
  CHECK(std::abs(walker.pose.position.z - view.home.position.z) < 1e-3);  // on the horizontal plane
  CHECK(std::abs(walker.pose.right().z) < 1e-4f);
  CHECK(glm::distance(walker.pose.position, view.home.position) > 0.1);
  // A Viewpoint's coordinates decide.
  const View entered = view_of(standing(kSeen, UpRule::z), kSize, {});
  CHECK(entered.navigation.up == glm::vec3(0, 1, 0));
  CHECK(entered.home.position == glm::dvec3(0, 0, 30));
}

TEST_CASE("keeps the user's up axis when the file is read again, and Viewpoints in place") {
  View view = view_of(standing(kTower, UpRule::z), kSize, {}, nullptr, {UpAxis::minus_y});
  CHECK(level(view.home, {0, -1, 0}));
  const View again = renewed(view, standing(kTower, UpRule::z), kSize);
  CHECK(again.style.up == UpAxis::minus_y);
  CHECK(again.navigation.up == glm::vec3(0, -1, 0));
  choose_up(view, UpAxis::automatic);
  CHECK(view.navigation.up == glm::vec3(0, 0, 1));
  CHECK(level(view.home, {0, 0, 1}));
  View entered = view_of(standing(kSeen, UpRule::y), kSize, {}, nullptr, {UpAxis::z});
  CHECK(entered.home.position == glm::dvec3(0, 0, 30));
  CHECK(close(entered.home.up(), {0, 1, 0}));
  CHECK(entered.navigation.up == glm::vec3(0, 0, 1));
  CHECK(upright_of(entered) == upright_of(UpAxis::z));
  choose_up(entered, UpAxis::automatic);
  CHECK(entered.navigation.up == glm::vec3(0, 1, 0));
}

TEST_CASE(
    "keeps parallel projection at Viewpoints, in other window sizes and after reading again") {
  ViewStyle style;
  style.parallel = true;
  View view = view_of(standing(kTower, UpRule::y), kSize, {}, nullptr, style);
  CHECK(view.navigation.pose.height > 4);
  fit_home(view, {300, 600});
  CHECK(view.navigation.pose.height > 0);
  CHECK(at_home(view));
  CHECK(renewed(view, standing(kTower, UpRule::y), kSize).navigation.pose.height > 0);
  View entered = view_of(standing(kSeen, UpRule::y), kSize, {}, nullptr, style);
  CHECK(entered.navigation.pose.height > 0);
  CHECK(entered.navigation.pose.position == glm::dvec3(0, 0, 30));
  choose_parallel(entered, false);
  CHECK(entered.navigation.pose.height == 0);
  CHECK(at_home(entered));
}

TEST_CASE("takes the up axis from format or header, and a look of its own from worlds only") {
  const ScratchFolder folder;
  const auto read = [&](const std::string& name, const std::string& text) {
    LoadedWorld world = load_world(folder.write(name, text));
    INFO(name);
    CHECK(world.scene);
    return std::pair{world.upright({1, 1, 1}), world.authored};
  };
  const std::string triangle =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
      "0\nendloop\nendfacet\nendsolid\n";
  const auto three_quarter = [](Upright upright) {
    upright.three_quarter = true;
    return upright;
  };
  CHECK(read("a.stl", triangle) == std::pair{upright_of(UpRule::z, {}), false});
  CHECK(read("a.wrl", std::string("#VRML V2.0 utf8\n") + kTower) == std::pair{Upright{}, true});
  const auto nrrd = [](const std::string& space) {
    std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 8 8\n" + space + "encoding: raw\n\n";
    for (int i = 0; i < 512; ++i) text += static_cast<char>(i % 8 > 2 && i / 64 > 2 ? 200 : 10);
    return text;
  };
  CHECK(read("plain.nrrd", nrrd("")) == std::pair{three_quarter({{0, 0, -1}, {0, -1, 0}}), false});
  CHECK(read("patient.nrrd", nrrd("space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n")) ==
        std::pair{three_quarter({{0, 0, 1}, {0, -1, 0}}), false});
}

TEST_CASE("shows objects from the front, right and above at first, but flat pictures and worlds from the front") {
  LoadedWorld world;
  world.authored = false;
  CHECK(world.upright({1, 1, 1}).three_quarter);
  CHECK(world.upright({2, 0, 2}).three_quarter);  // terrain
  CHECK_FALSE(world.upright({2, 1, 0}).three_quarter);
  world.stated_up = Upright{{0, 0, 1}, {0, -1, 0}};
  CHECK_FALSE(world.upright({2, 0, 2}).three_quarter);
  CHECK(world.upright({2, 1, 0}).three_quarter);
  world.authored = true;
  CHECK_FALSE(world.upright({1, 1, 1}).three_quarter);
}

}  // namespace gs::app::view_style_test
