#include "app/formats/common/upright.h"
#include "app/formats/content_types.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <string>
#include <utility>
#include <vector>

// Tests of the up axis of files.
namespace gs::app::upright_test {

using Metadata = std::vector<std::pair<std::string, std::string>>;

TEST_CASE("gives each up axis a perpendicular front in a right-handed system") {
  for (const UpAxisRow& row : up_axes()) {
    INFO(row.name);
    const Upright upright = upright_of(row.axis);
    CHECK(glm::dot(upright.up, upright.front) == 0);
    CHECK(glm::determinant(world_from_upright(upright)) == 1);
    CHECK(find_up_axis(row.name) == row.axis);
    CHECK(name_of(row.axis) == row.name);
  }
  CHECK(upright_of(UpAxis::automatic) == Upright{});
  CHECK(upright_of(UpAxis::z) == Upright{{0, 0, 1}, {0, -1, 0}});
  CHECK(upright_of(UpAxis::minus_y) == Upright{{0, -1, 0}, {0, 0, -1}});
  CHECK(find_up_axis("+z") == UpAxis::z);
  for (const char* bad : {"", "up", "--z", "Z", "zz", "+-z"}) CHECK_FALSE(find_up_axis(bad));
  const glm::vec3 slanted = glm::normalize(glm::vec3(1, 2, 3));
  CHECK(std::abs(glm::dot(upright_along(slanted).front, slanted)) < 1e-6f);
}

TEST_CASE("assumes the up axis of the format if a file names none") {
  const auto up_of = [](const char* name) { return content_type_of(name, {}).up; };
  CHECK(up_of("a.wrl") == UpRule::y);
  CHECK(up_of("a.glb") == UpRule::y);
  CHECK(up_of("a.obj") == UpRule::y);
  CHECK(up_of("a.stl") == UpRule::z);
  CHECK(up_of("a.ply") == UpRule::by_shape);
  CHECK(up_of("a.xyz") == UpRule::survey);
  CHECK(up_of("a.splat") == UpRule::y);  // rotated by its reader
  CHECK(up_of("a.spz") == UpRule::y);
  CHECK(up_of("a.nii.gz") == UpRule::patient_r);
  CHECK(up_of("a.mha") == UpRule::patient_s);
  CHECK(up_of("a.nhdr") == UpRule::slices);
  CHECK(up_of("a.vti") == UpRule::y);
  CHECK(upright_of(UpRule::by_shape, {1, 1, 1.6f}) == Upright{{0, 0, 1}, {0, 1, 0}});
  CHECK(upright_of(UpRule::by_shape, {1, 1, 1.4f}) == Upright{});
  CHECK(upright_of(UpRule::by_shape, {0, 0, 0}) == Upright{});
  CHECK(upright_of(UpRule::z, {1, 1, 1}) == Upright{{0, 0, 1}, {0, -1, 0}, true});
  CHECK(upright_of(UpRule::survey, {60, 40, 9}) == upright_of(UpAxis::z));
  CHECK(upright_of(UpRule::survey, {1, 2, 1}) == Upright{});
}

TEST_CASE("accepts the up axis that a file names, if it is valid") {
  CHECK_FALSE(stated_upright(Metadata{}));
  CHECK_FALSE(stated_upright(Metadata{{"title", "up"}, {"up", "there"}, {"space", "3D-right-handed"}}));
  CHECK(stated_upright(Metadata{{"up", "z"}}) == upright_of(UpAxis::z));
  CHECK(stated_upright(Metadata{{"up", "z"}, {"view", "three-quarter"}}) == upright_of(UpRule::z, {}));
  CHECK(stated_upright(Metadata{{"up", "z"}, {"view", "from afar"}}) == upright_of(UpAxis::z));
  CHECK(stated_upright(Metadata{{"up", "z"}, {"front", "y"}}) == Upright{{0, 0, 1}, {0, 1, 0}});
  CHECK(stated_upright(Metadata{{"up", "z"}, {"front", "-z"}}) == upright_of(UpAxis::z));
  CHECK(stated_upright(Metadata{{"space", "left-posterior-superior"}}) == Upright{{0, 0, 1}, {0, -1, 0}});
  CHECK(stated_upright(Metadata{{"space", "right-anterior-superior-time"}}) == Upright{{0, 0, 1}, {0, 1, 0}});
  CHECK(stated_upright(Metadata{{"space", "LPS"}}) == Upright{{0, 0, 1}, {0, -1, 0}});
  CHECK(stated_upright(Metadata{{"space", "RAST"}}) == Upright{{0, 0, 1}, {0, 1, 0}});
  CHECK(stated_upright(Metadata{{"space", "superior-superior-superior"}}) == std::nullopt);
  CHECK(stated_upright(Metadata{{"space", "LPS"}, {"up", "x"}}) == upright_of(UpAxis::x));
}

TEST_CASE("restores the up axis of a stream, and omits the default of VRML97") {
  CHECK(metadata_of(Upright{}).empty());
  for (const UpRule rule : {UpRule::z, UpRule::slices, UpRule::patient_s, UpRule::patient_r}) {
    const Upright upright = upright_of(rule, glm::vec3(1));
    CHECK(stated_upright(metadata_of(upright)) == upright);
  }
  CHECK(metadata_of(upright_of(UpAxis::z)).size() == 1);
}

TEST_CASE("a single slice is seen face on, with its first row on top") {
  const Upright face{{0, -1, 0}, {0, 0, -1}};
  for (const UpRule rule : {UpRule::slices, UpRule::patient_s, UpRule::patient_r}) {
    CHECK(upright_of(rule, {40, 30, 0}) == face);
    CHECK_FALSE(upright_of(rule, {40, 30, 20}) == face);
    CHECK_FALSE(upright_of(rule, {0, 0, 0}) == face);
    CHECK(upright_of(rule, {0, 30, 20}).front == glm::vec3(1, 0, 0));
  }
  CHECK(upright_of(UpRule::y, {40, 30, 0}) == Upright{});
}

}  // namespace gs::app::upright_test
