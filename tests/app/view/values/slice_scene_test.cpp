#include "app/view/values/slice_scene.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <vector>

namespace gs::app::slice_scene_test {
namespace {

/// Returns values x + 10 y + 100 z of 4 x 3 x 2 voxels, 2 x 1 x 5 apart from (7, 0, 0) on, with one missing.
qnv::VolumeSource small_volume() {
  qnv::VolumeSource source;
  source.layout.dimensions = {4, 3, 2};
  source.layout.axes = {glm::vec3(2, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 5)};
  source.layout.origin = {7, 0, 0};
  source.layout.type = qnv::VoxelType::f32;
  source.read = [](std::uint32_t z, std::span<std::byte> slice) {
    std::vector<float> values;
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x) values.push_back(static_cast<float>(x + 10 * y) + 100 * static_cast<float>(z));
    if (z == 1) values[0] = std::nanf("");
    std::memcpy(slice.data(), values.data(), slice.size());
    return true;
  };
  return source;
}

std::shared_ptr<const VolumeGrid> grid_of(std::uint64_t most = VolumeGrid::kMaxVoxels) {
  auto taken = VolumeGrid::take(small_volume(), nullptr, own_budget(), most);
  if (auto* problem = std::get_if<std::string>(&taken)) FAIL(*problem);
  return std::get<std::shared_ptr<const VolumeGrid>>(taken);
}

}  // namespace

TEST_CASE("returns the values of voxels, and interpolates linearly between them") {
  const auto grid = grid_of();
  CHECK(grid->step() == 1);
  CHECK(grid->value_range() == std::pair<float, float>{0, 123});
  CHECK(grid->voxel_at({11, 1, 5}) == glm::dvec3(2, 1, 1));
  CHECK(grid->place_of({2, 1, 1}) == glm::dvec3(11, 1, 5));
  CHECK(*grid->nearest({2.4, 0.6, 0.2}) == 12);
  CHECK_FALSE(grid->nearest({0, 0, 1}));  // missing
  CHECK_FALSE(grid->nearest({-0.6, 0, 0}));
  CHECK_FALSE(grid->nearest({0, 0, std::nan("")}));
  CHECK(*grid->nearest({3.49, 2.49, 0}) == 23);
}

TEST_CASE("keeps every second voxel of a grid that is too large") {
  const auto grid = grid_of(10);
  CHECK(grid->step() == 2);
  CHECK(grid->kept(0) == 2);
  CHECK(grid->kept(1) == 2);
  CHECK(grid->kept(2) == 1);
  CHECK(grid->kept_value(1, 1, 0) == 22);
  CHECK(*grid->nearest({3.4, 2, 1}) == 22);
  Limits limits;
  limits.memory = 0;
  CHECK(std::holds_alternative<std::string>(
      VolumeGrid::take(small_volume(), nullptr, std::make_shared<Budget>(limits), 1000)));
  const std::atomic<bool> stop{true};
  CHECK(std::holds_alternative<std::string>(VolumeGrid::take(small_volume(), &stop, own_budget(), 1000)));
}

TEST_CASE("draws a slice with a pixel per voxel, black to white over the window, and holes at missing values") {
  const auto grid = grid_of();
  VolumeSlices slices;
  slices.window = {{0, 102}};
  slices.places[2] = 0;
  const render::Image low = slice_image(*grid, slices, 2);
  CHECK(low.width == 4);
  CHECK(low.height == 3);
  REQUIRE(low.components == 3);
  // The bottom row of the picture is y = 0, with the values 0 to 3 of 102.
  for (std::uint32_t x = 0; x < 4; ++x)
    CHECK(low.pixels[(2 * 4 + x) * 3] == static_cast<int>(std::lround(static_cast<double>(x) / 102 * 255)));
  CHECK(low.pixels[0] == std::lround(20.0 / 102 * 255));
  slices.places[2] = 1;
  const render::Image high = slice_image(*grid, slices, 2);
  REQUIRE(high.components == 4);
  CHECK(high.pixels[2 * 4 * 4 + 3] == 0);      // the missing voxel
  CHECK(high.pixels[2 * 4 * 4 + 7] == 255);    // beside it
  CHECK(high.pixels[(2 * 4 + 3) * 4] == 255);  // 103 is beyond the window
  slices.places[0] = 0.5f;                     // of 0 to 3: voxel 2
  CHECK(slice_voxel(*grid, slices, 0) == 2);
  const render::Image side = slice_image(*grid, slices, 0);  // y to the right, z upwards
  CHECK(side.width == 3);
  CHECK(side.height == 2);
  CHECK(side.pixels[(1 * 3 + 1) * 3] == std::lround(12.0 / 102 * 255));
}

TEST_CASE("places slices at their voxels, beside the volume or alone") {
  const auto grid = grid_of();
  render::RenderList list;
  render::SplatItem item;
  item.geometry = std::make_shared<const qnv::Geometry>(qnv::Volume());
  item.world_from_node[3] = {100, 0, 0, 1};
  list.splats.push_back(item);
  SliceScene scene;
  VolumeSlices slices;
  CHECK(&scene.with_slices(list, grid, slices) == &list);
  slices.shown[1] = true;
  slices.places[1] = 1;
  CHECK(&scene.with_slices(list, nullptr, slices) == &list);
  const render::RenderList& shown = scene.with_slices(list, grid, slices);
  REQUIRE(shown.items.size() == 2);  // the plane and its frame
  const render::DrawItem& plane = shown.items.front();
  CHECK(plane.world_from_node == item.world_from_node);
  // The plane is at y = 2. Voxels extend half a voxel beyond their centres.
  CHECK(plane.mesh->bounds.lower == glm::vec3(6, 2, -2.5f));
  CHECK(plane.mesh->bounds.upper == glm::vec3(14, 2, 7.5f));
  CHECK(shown.bounds.lower.x == 106);
  CHECK(shown.splats.size() == 1);
  const auto image = plane.texture.image;
  slices.alone = true;
  const render::RenderList& alone = scene.with_slices(list, grid, slices);
  CHECK(alone.splats.empty());
  CHECK(alone.items.front().texture.image == image);  // kept
  // The change number states whether the list is unchanged.
  const std::uint64_t before = alone.changes;
  CHECK(before != 0);
  CHECK(scene.with_slices(list, grid, slices).changes == before);
  slices.places[1] = 0;
  CHECK(scene.with_slices(list, grid, slices).changes != before);
  const std::uint64_t moved = scene.with_slices(list, grid, slices).changes;
  list.changes = render::next_change();  // the world has advanced
  CHECK(scene.with_slices(list, grid, slices).changes != moved);
}

TEST_CASE("accepts planes by voxel or fraction, and nothing else") {
  VolumeSlices slices;
  const auto half = read_slice_wish("y=50%"), third = read_slice_wish("z=3");
  REQUIRE((half && third));
  apply(*half, {10, 11, 12}, slices);
  apply(*third, {10, 11, 12}, slices);
  CHECK(slices.shown == std::array<bool, 3>{false, true, true});
  CHECK(slices.places[1] == 0.5f);
  CHECK(slices.places[2] == Approx(3.0 / 11));
  apply(*read_slice_wish("x=400"), {10, 11, 12}, slices);
  CHECK(slices.places[0] == 1);
  apply(*read_slice_wish("x=0"), {1, 1, 1}, slices);
  CHECK(slices.places[0] == 0);
  for (const char* wrong : {"", "x", "x=", "w=1", "x=-1", "x=101%", "x=nan", "x=1e999", "x=5 ", "x=%"})
    CHECK_FALSE(read_slice_wish(wrong));
}

}  // namespace gs::app::slice_scene_test
