#include "app/view/camera_text.h"
#include "tests/app/interface/driver.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <cmath>
#include <string>
#include <utility>
#include <variant>

// Tests of the camera by keys and menus: sides, up axis, parallel projection, undo, seek, and clipboard.
namespace gs::app::camera_interface_test {

using driver::Driver;

namespace {

constexpr char kBoxes[] =
    "NavigationInfo { type [ \"EXAMINE\" \"ANY\" ] } Shape { geometry Box { size 2 4 6 } } "
    "Transform { translation 3 0 0 children Shape { geometry Box { } } }";

const Navigation& navigation(Driver& user) { return user.session().view()->navigation; }
const Pose& pose(Driver& user) { return navigation(user).pose; }

bool near(const glm::vec3& a, const glm::vec3& b) { return glm::distance(a, b) < 1e-3f; }

}  // namespace

TEST_CASE("shows an object from its sides by keys, relative to the chosen up axis") {
  Driver user;
  user.show_world(kBoxes);
  const std::pair<char, glm::vec3> sides[] = {{'1', {0, 0, -1}}, {'2', {0, 0, 1}},  {'3', {1, 0, 0}},
                                              {'4', {-1, 0, 0}}, {'5', {0, -1, 0}}, {'6', {0, 1, 0}}};
  for (const auto& [key, forward] : sides) {
    user.press(letter_key(key), false, true);
    user.wait(1);
    INFO(key);
    CHECK(near(pose(user).forward(), forward));
    CHECK(near(navigation(user).center, {1.5f, 0, 0}));
  }
  user.click("View");
  user.click("Up axis");
  user.click("Up: +Z");
  CHECK(user.session().view()->style.up == UpAxis::z);
  CHECK(navigation(user).up == glm::vec3(0, 0, 1));
  user.press(letter_key('1'), false, true);
  user.wait(1);
  CHECK(near(pose(user).forward(), {0, 1, 0}));
  CHECK(near(pose(user).up(), {0, 0, 1}));
  user.click("Navigate");
  user.click("Standard views");
  user.click("View from above");
  user.wait(1);
  CHECK(near(pose(user).forward(), {0, 0, -1}));
  CHECK(user.session().view()->navigation.mode == NavigationMode::examine);  // 1 alone chooses a mode
}

TEST_CASE("moves an unmoved camera to the first view of the new up axis") {
  Driver user;
  user.show_world(kBoxes);
  user.session().input().run(Action::up_minus_z);
  user.wait(1);
  CHECK(near(pose(user).up(), {0, 0, -1}));
  CHECK(at_home(*user.session().view()));
  user.session().input().run(Action::up_auto);
  user.wait(1);
  CHECK(near(pose(user).up(), {0, 1, 0}));
}

TEST_CASE("keeps a Viewpoint in place for any up axis") {
  Driver other;
  other.show_world(std::string(kBoxes) + " Viewpoint { position 0 1 9 orientation 1 0 0 0.3 }");
  const Pose before = pose(other);
  other.session().input().run(Action::up_z);
  other.wait(1);
  CHECK(pose(other).position == before.position);
  CHECK(pose(other).orientation == before.orientation);
  CHECK(navigation(other).up == glm::vec3(0, 0, 1));
}

TEST_CASE("toggles parallel projection with O, and keeps the size of the target") {
  Driver user;
  user.show_world(kBoxes);
  const Pose before = pose(user);
  user.press(letter_key('O'));
  CHECK(user.session().view()->style.parallel);
  const double expected = 2 * std::tan(before.field_of_view / 2.0) * before.position.z;
  CHECK(std::abs(pose(user).height - expected) < 0.01 * expected);
  CHECK(at_home(*user.session().view()));
  CHECK(user.sees("Parallel projection"));
  // Each destination is seen from that side.
  user.press(letter_key('5'), false, true);
  user.wait(1);
  CHECK(pose(user).height > 0);
  user.press(Key::home);
  user.wait(1);
  CHECK(std::abs(pose(user).height - expected) < 0.01 * expected);
  user.press(letter_key('O'));
  CHECK(pose(user).height == 0);
  CHECK(glm::distance(pose(user).position, before.position) < 1e-3);
}

TEST_CASE("undoes and redoes movements, and leaves the world alone while text is typed") {
  Driver user;
  user.show_world(kBoxes);
  const Pose first = pose(user);
  user.press(letter_key('5'), false, true);
  user.wait(2);
  const Pose above = pose(user);
  user.press(letter_key('3'), false, true);
  user.wait(2);
  user.press(letter_key('Z'), true);
  user.wait(1);
  CHECK(glm::distance(pose(user).position, above.position) < 1e-6);
  user.press(letter_key('Z'), true);
  user.wait(1);
  CHECK(glm::distance(pose(user).position, first.position) < 1e-6);
  CHECK_FALSE(user.session().camera().can_undo_move(-1));
  user.press(letter_key('Z'), true, true);
  user.wait(1);
  CHECK(glm::distance(pose(user).position, above.position) < 1e-6);
  user.press(letter_key('P'), true, true);  // opens the palette, which takes the focus
  user.type("fit");
  user.press(letter_key('Z'), true);
  user.press(Key::escape);
  user.wait(1);
  CHECK(glm::distance(pose(user).position, above.position) < 1e-6);
}

TEST_CASE("levels a rolled view, and moves towards a clicked point") {
  Driver user;
  user.show_world(kBoxes);
  Pose rolled = pose(user);
  rolled.orientation = glm::angleAxis(0.8f, glm::vec3(0, 0, 1));
  user.session().camera().go_to(rolled);
  user.wait(1);
  CHECK(std::abs(pose(user).right().y) > 0.5f);
  user.press(letter_key('U'));
  user.wait(1);
  CHECK(std::abs(pose(user).right().y) < 1e-4f);
  const double before = pose(user).position.z;
  user.press(letter_key('K'));
  CHECK(user.session().camera().seeking());
  CHECK(user.sees("Seek: click a point to move halfway to it"));
  const Viewport place = user.picture();
  const auto box = pixel_that_sees(pose(user), {0.5, 0.5, 3}, place.size());
  REQUIRE(box);
  user.click(*box + glm::vec2(place.left, place.top));
  user.settle();
  CHECK_FALSE(user.sees("Seek: click a point to move halfway to it"));
  user.wait(1);
  CHECK_FALSE(user.session().camera().seeking());
  CHECK(glm::distance(navigation(user).center, glm::dvec3(0.5, 0.5, 3)) < 0.05);
  CHECK(std::abs((pose(user).position.z - navigation(user).center.z) * 2 - (before - navigation(user).center.z)) < 0.1);
  user.press(letter_key('K'));
  user.press(Key::escape);
  CHECK_FALSE(user.session().camera().seeking());
  CHECK_FALSE(user.sees("Seek: click a point to move halfway to it"));
  user.press(letter_key('K'));
  user.click(glm::vec2(place.left, place.top) + 3.0f);
  CHECK(user.sees("No object at this point"));
}

TEST_CASE("copies and pastes a camera, and reports invalid text") {
  Driver user;
  user.show_world(kBoxes);
  user.press(letter_key('5'), false, true);
  user.wait(1);
  user.press(letter_key('O'));
  const Pose kept = pose(user);
  user.press(letter_key('C'), true, true);
  CHECK(user.controller().ui().clipboard() == camera_text(kept));
  user.press(letter_key('O'));
  user.press(letter_key('1'), false, true);
  user.wait(1);
  user.press(letter_key('V'), true);
  user.wait(1);
  CHECK(glm::distance(pose(user).position, kept.position) < 1e-5);
  CHECK(std::abs(pose(user).height - kept.height) < 1e-6 * kept.height);
  CHECK(user.session().view()->style.parallel);
  user.click("Navigate");
  user.click("Copy camera as Viewpoint node");
  CHECK(user.controller().ui().clipboard().starts_with("Viewpoint { position "));
  CHECK(std::holds_alternative<Pose>(read_camera(user.controller().ui().clipboard())));
  user.controller().ui().set_clipboard("nothing of the kind");
  user.press(letter_key('V'), true);
  CHECK(user.sees("The clipboard has no camera"));
  CHECK(glm::distance(pose(user).position, kept.position) < 1e-5);
}

TEST_CASE("shows axes in the corner of unstyled objects, and the size of the grid") {
  Driver user;
  LoadedWorld world = world_of(kBoxes);
  world.path = "head.mha";
  world.authored = false;
  world.up = UpRule::patient_s;
  auto document = hold_world(std::move(world));
  begin_world(*document, 1000);
  user.session().readers().show(std::move(document));
  user.settle();
  CHECK(user.session().view()->style.backdrop);
  CHECK(near(pose(user).right(), glm::normalize(glm::vec3(pose(user).right().x, pose(user).right().y, 0))));
  CHECK(pose(user).up().z > 0.8f);
  user.session().input().run(Action::side_front);
  user.wait(1);
  CHECK(near(pose(user).up(), {0, 0, 1}));
  const float em = ImGui::GetFontSize(), half = 3.2f * em, length = half - 0.8f * em;
  const Viewport place = user.picture();
  const glm::vec2 center(place.left + half, place.top + place.height - half);
  user.click(center + glm::vec2(length, 0));  // +X
  user.wait(1);
  CHECK(near(pose(user).forward(), {-1, 0, 0}));
  CHECK(near(pose(user).up(), {0, 0, 1}));
  user.click(center - glm::vec2(0, length));  // +Z is up now
  user.wait(1);
  CHECK(near(pose(user).forward(), {0, 0, -1}));
  CHECK_FALSE(user.sees("Grid:"));
  user.press(letter_key('N'));
  CHECK(user.sees("Grid: 0.5"));
  // Without axes, a click there turns the world and chooses no side.
  user.click("View");
  user.click("Coordinate axes");
  CHECK_FALSE(user.session().view()->style.axes);
  const Pose before = pose(user);
  user.click(center + glm::vec2(length, 0));
  user.wait(1);
  CHECK(pose(user).orientation == before.orientation);
  user.press(letter_key('X'));
  CHECK(user.session().view()->style.display == render::DisplayMode::edges);
  CHECK(user.sees("Faces: filled, with edges"));
  user.click("View");
  user.click("Faces");
  user.click("Faces: points");
  CHECK(user.session().view()->style.display == render::DisplayMode::points);
}

}  // namespace gs::app::camera_interface_test
