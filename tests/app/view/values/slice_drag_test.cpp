#include "app/view/values/slice_drag.h"
#include "app/view/values/slice_scene.h"

#include <catch2/catch.hpp>

#include <cstring>
#include <vector>

namespace gs::app::slice_drag_test {
namespace {

/// Returns 11 voxels per axis, 1 apart, around 0.
std::shared_ptr<const VolumeGrid> cube() {
  qnv::VolumeSource source;
  source.layout.dimensions = {11, 11, 11};
  source.layout.axes = {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};
  source.layout.origin = {-5, -5, -5};
  source.layout.type = qnv::VoxelType::u8;
  source.read = [](std::uint32_t z, std::span<std::byte> slice) {
    std::memset(slice.data(), static_cast<int>(z), slice.size());
    return true;
  };
  auto taken = VolumeGrid::take(source, nullptr, own_budget(), VolumeGrid::kMaxVoxels);
  return std::get<std::shared_ptr<const VolumeGrid>>(taken);
}

constexpr glm::vec2 kSize(800, 600);

glm::vec2 pixel(const Pose& pose, const glm::dvec3& place) {
  const auto seen = pixel_that_sees(pose, place, kSize);
  REQUIRE(seen);
  return *seen;
}

}  // namespace

TEST_CASE("grabs a slice at its edges only") {
  const auto grid = cube();
  Pose pose;
  pose.position = {0, 0, 30};
  VolumeSlices slices;
  slices.shown = {true, false, true};
  slices.places = {0.5f, 0.5f, 0.2f};
  const glm::dmat4 world(1);
  const auto at = [&](const glm::dvec3& place, float reach = 7) {
    return slice_at_edge(*grid, slices, world, pose, kSize, pixel(pose, place), reach);
  };
  // The slice across X is seen edge on, the one across Z from the front, at its voxel 2.
  const auto across_z = at({4, 5.5, -3});
  REQUIRE(across_z);
  CHECK(across_z->axis == 2);
  CHECK(across_z->place == 0.2f);
  CHECK(across_z->point.x == Approx(4).margin(0.01));
  CHECK(across_z->point.y == Approx(5.5).margin(0.01));
  CHECK(across_z->point.z == Approx(-3).margin(0.01));
  CHECK(across_z->across.z == Approx(10));
  REQUIRE(at({0, 2, 5.5}));
  CHECK(at({0, 2, 5.5})->axis == 0);
  CHECK_FALSE(at({3, 3, -3}));  // in its middle
  CHECK_FALSE(at({4, 7, -3}));  // beside it
  CHECK_FALSE(at({4, 5.55, -3}, 0));
  slices.shown = {false, false, false};
  CHECK_FALSE(at({4, 5.5, -3}));
  // Edges behind the viewer cannot be grabbed.
  slices.shown[2] = true;
  pose.position = {0, 0, -20};
  CHECK_FALSE(slice_at_edge(*grid, slices, world, pose, kSize, {400, 300}, 1000));
}

TEST_CASE("keeps the grabbed point of a slice under the pointer during the drag") {
  const auto grid = cube();
  VolumeSlices slices;
  slices.shown = {true, false, false};
  for (const bool parallel : {false, true}) {
    Pose pose;
    pose.position = {3, 4, 30};
    pose = with_parallel_rays(pose, parallel, 30);
    // The volume is twice as large and rotated: its x is the world's -y.
    glm::dmat4 world(0);
    world[0][1] = -2;
    world[1][0] = 2;
    world[2][2] = 2;
    world[3][3] = 1;
    const auto in_world = [&](const glm::dvec3& voxel) {
      return glm::dvec3(world * glm::dvec4(grid->place_of(voxel), 1));
    };
    const glm::dvec3 edge = in_world({5, 3, 10.5});
    const auto grip = slice_at_edge(*grid, slices, world, pose, kSize, pixel(pose, edge), 3);
    REQUIRE(grip);
    for (const double voxel : {0.0, 2.0, 7.0, 10.0})
      CHECK(dragged_place(*grip, pose, kSize, pixel(pose, in_world({voxel, 3, 10.5}))) ==
            Approx(voxel / 10).margin(0.002));
    CHECK(dragged_place(*grip, pose, kSize, pixel(pose, in_world({14, 3, 10.5}))) == 1);
    CHECK(dragged_place(*grip, pose, kSize, pixel(pose, in_world({-4, 3, 10.5}))) == 0);
  }
}

TEST_CASE("drags a slice up and down if the viewer looks along its axis") {
  const auto grid = cube();
  Pose pose;
  pose.position = {0, 0, 60};
  VolumeSlices slices;
  slices.shown = {false, false, true};
  const glm::vec2 at = pixel(pose, {0, 5.5, 0});
  const auto grip = slice_at_edge(*grid, slices, glm::dmat4(1), pose, kSize, at, 5);
  REQUIRE(grip);
  CHECK(dragged_place(*grip, pose, kSize, at) == 0.5f);
  CHECK(dragged_place(*grip, pose, kSize, at - glm::vec2(0, 60)) == Approx(0.6));
  CHECK(dragged_place(*grip, pose, kSize, at + glm::vec2(0, 120)) == Approx(0.3));
  CHECK(dragged_place(*grip, pose, kSize, at + glm::vec2(0, 1e6f)) == 0);
}

}  // namespace gs::app::slice_drag_test
