#include "app/view/values/fine_values.h"

#include "app/view/derived/surface_parts.h"
#include "app/view/derived/volume_derivations.h"
#include "app/view/values/slice_scene.h"
#include "base/limits.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace fine_values_test {

constexpr double kCentre = 15.3, kRadius = 9.2;

// Distance from the centre of a ball; linear enough for a comparison of surfaces.
float field(double x, double y, double z) {
  return static_cast<float>(
      std::sqrt((x - kCentre) * (x - kCentre) + (y - kCentre) * (y - kCentre) + (z - kCentre) * (z - kCentre)));
}

// Part of a finer level, with one more sample after its end.
qnv::ValueBrick part_of(int level, std::uint32_t fine, std::array<std::uint32_t, 3> first, std::uint32_t edge) {
  qnv::ValueBrick brick;
  brick.level = level;
  brick.core_first = brick.first = first;
  brick.core_size = {edge, edge, edge};
  brick.size = {edge + 1, edge + 1, edge + 1};
  const double step = 1.0 / fine;
  brick.steps = {step, step, step};
  brick.slope = 1e-4;
  auto samples = std::make_shared<std::vector<std::int32_t>>();
  for (std::uint32_t z = 0; z <= edge; ++z)
    for (std::uint32_t y = 0; y <= edge; ++y)
      for (std::uint32_t x = 0; x <= edge; ++x)
        samples->push_back(static_cast<std::int32_t>(
            std::lround(field((first[0] + x) * step, (first[1] + y) * step, (first[2] + z) * step) * 1e4)));
  brick.samples = std::move(samples);
  return brick;
}

std::shared_ptr<const VolumeGrid> grid_with_parts() {
  qnv::VolumeLayout layout;
  layout.dimensions = {32, 32, 32};
  const auto source =
      test::volume_of(layout, [](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return field(x, y, z); });
  // One part of four times the resolution inside of one of twice the resolution.
  qnv::VolumeValues about;
  about.level = 2;
  about.whole = {128, 127, 126};
  about.bricks = {part_of(0, 4, {32, 32, 32}, 16), part_of(1, 2, {16, 16, 16}, 16)};
  auto made = VolumeGrid::take(source, nullptr, own_budget(), VolumeGrid::kMaxVoxels, &about);
  REQUIRE(std::holds_alternative<std::shared_ptr<const VolumeGrid>>(made));
  return std::get<0>(made);
}

TEST_CASE("fine values: The value at a point is that of the finest part there") {
  const auto grid = grid_with_parts();
  CHECK(grid->nearest({9.3, 10.7, 9.1}).value() == Approx(field(9.25, 10.75, 9)).margin(1e-3));
  CHECK(grid->nearest({13.4, 14.6, 15.1}).value() == Approx(field(13.5, 14.5, 15)).margin(1e-3));
  CHECK(grid->nearest({20.4, 14.6, 15.1}).value() == Approx(field(20, 15, 15)).margin(1e-3));
  CHECK_FALSE(grid->nearest({32, 1, 1}));
}

TEST_CASE("fine values: A finer grid has the samples of each part at their places") {
  const auto grid = grid_with_parts();
  CHECK(FineValues::factor_for(*grid, 1 << 24) == 4);
  CHECK(FineValues::factor_for(*grid, 64 * 64 * 64) == 2);
  CHECK(FineValues::factor_for(*grid, 64 * 64, 2) == 2);
  const FineValues fine(*grid, 4);
  CHECK(fine.size() == std::array<std::uint32_t, 3>{128, 128, 128});
  std::vector<float> values;
  fine.read({0, 37, 40}, {128, 1, 1}, values);
  for (std::uint32_t x = 32; x < 48; ++x) CHECK(values[x] == Approx(field(x / 4.0, 37 / 4.0, 10)).margin(1e-3));
  CHECK(values[56] == Approx(field(14, 9, 10)).margin(1e-3));
  CHECK(values[100] == Approx(field(25, 9, 10)).margin(1e-3));
}

TEST_CASE("fine values: Slices and projections have the pixels of the finest part") {
  const auto grid = grid_with_parts();
  VolumeSlices slices;
  slices.shown = {false, false, true};
  slices.places = {0.5f, 0.5f, 10.0f / 31};
  const render::Image image = slice_image(*grid, slices, 2);
  CHECK(image.width == 128);
  CHECK(image.height == 128);
  auto projection = projection_of(*grid, {}, own_budget());
  REQUIRE(std::holds_alternative<std::shared_ptr<const VolumeProjection>>(projection));
  const auto& look = std::get<0>(projection)->look;
  CHECK(look->voxels->width == 128);
  CHECK(look->dimensions.x == Approx(32));
}

TEST_CASE("fine values: The isosurface of all parts is closed up to steps between levels") {
  const auto grid = grid_with_parts();
  const auto parts = surface_parts(grid);
  REQUIRE(parts.size() == 3);
  auto made = isosurface_mesh(grid, static_cast<float>(kRadius), own_budget());
  REQUIRE(std::holds_alternative<std::shared_ptr<const vrml::Mesh>>(made));
  const vrml::Mesh& mesh = *std::get<0>(made);
  REQUIRE(mesh.indices.size() > 3000);
  double area = 0, worst = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                    c = mesh.positions[mesh.indices[i + 2]];
    area += static_cast<double>(glm::length(glm::cross(b - a, c - a))) / 2;
  }
  for (const glm::vec3& p : mesh.positions)
    worst = std::max(worst, std::abs(static_cast<double>(field(p.x, p.y, p.z)) - kRadius));
  // Overlaps or gaps of one cell would change the area by percents.
  CHECK(area == Approx(4 * 3.14159265 * kRadius * kRadius).epsilon(0.006));
  CHECK(worst < 0.05);
}

}  // namespace fine_values_test
}  // namespace gs::app
