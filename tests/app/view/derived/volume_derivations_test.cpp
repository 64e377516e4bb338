#include "app/view/derived/volume_derivations.h"

#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/view/derived/volume_balls.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gs::app::volume_derivations_test {
namespace {

using test_balls::ball;
using test_balls::grid_of;

template <class Content>
std::shared_ptr<const Content> content_of(DerivedContent<Content> made) {
  if (const auto* problem = std::get_if<std::string>(&made)) FAIL(*problem);
  return std::get<0>(made);
}

WorldBudget no_memory() {
  Limits limits;
  limits.memory = 0;
  return std::make_shared<Budget>(limits);
}

}  // namespace

TEST_CASE("gives the stored voxels of a grid as a volume") {
  auto taken = VolumeGrid::take(ball(9), nullptr, own_budget(), 200);
  const auto grid = std::get<std::shared_ptr<const VolumeGrid>>(taken);
  REQUIRE(grid->step() == 2);
  for (const std::uint32_t stride : {1u, 2u}) {
    const qnv::VolumeSource source = source_of(grid, stride);
    CHECK_FALSE(qnv::check(source.layout));
    CHECK(source.layout.dimensions[0] == (stride == 1 ? 5 : 3));
    CHECK(source.layout.axes[1].y == static_cast<float>(stride));
    CHECK(source.layout.origin == glm::dvec3(3, 0, 0));
    std::vector<std::byte> scratch;
    std::vector<float> slice(qnv::slice_voxels(source.layout));
    REQUIRE(qnv::read_slice(source, 1, scratch, slice));
    CHECK(slice[1] == grid->kept_value(stride, 0, stride));
    CHECK(slice[source.layout.dimensions[0] + 2] == grid->kept_value(2 * stride, stride, stride));
    CHECK_FALSE(source.read(source.layout.dimensions[2], scratch));
  }
}

TEST_CASE("makes an isosurface with shared vertices in the space of the volume") {
  const auto grid = grid_of(ball(25));
  const auto mesh = content_of(isosurface_mesh(grid, 35, own_budget()));
  const glm::vec3 middle = glm::vec3(3, 0, 0) + glm::vec3(6);
  REQUIRE(mesh->positions.size() > 500);
  REQUIRE(mesh->normals.size() == mesh->positions.size());
  for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
    const glm::vec3 away = mesh->positions[i] - middle;
    CHECK(glm::length(away) == Approx(3.25).margin(0.05));
    CHECK(glm::dot(mesh->normals[i], glm::normalize(away)) > 0.95f);
  }
  // A closed surface: each edge has two triangles, and Euler's formula holds for a sphere.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::size_t i = 0; i < mesh->indices.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(mesh->indices[i + k], mesh->indices[i + (k + 1) % 3])];
  CHECK(std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 2; }));
  CHECK(mesh->positions.size() - edges.size() + mesh->indices.size() / 3 == 2);
  CHECK_FALSE(mesh->solid);
  CHECK(mesh->bounds.lower.x == Approx(5.75).margin(0.05));
}

TEST_CASE("makes a coarser isosurface if it has too many triangles, and none without memory") {
  const auto grid = grid_of(ball(25));
  const std::size_t whole = content_of(isosurface_mesh(grid, 35, own_budget()))->indices.size() / 3;
  const auto coarse = content_of(isosurface_mesh(grid, 35, own_budget(), nullptr, whole / 2));
  CHECK(coarse->indices.size() / 3 <= whole / 2);
  CHECK(coarse->indices.size() / 3 > whole / 8);
  CHECK(coarse->bounds.lower.x == Approx(5.75).margin(0.2));
  const auto draft = content_of(isosurface_mesh(grid, 35, own_budget(), nullptr, whole, 2));
  CHECK(draft->indices == coarse->indices);
  CHECK(draft_stride(*grid) == 1);
  CHECK(draft_stride(*grid_of(test_balls::ball(130))) == 2);
  CHECK(std::holds_alternative<std::string>(isosurface_mesh(grid, 35, no_memory())));
  CHECK(std::holds_alternative<std::string>(isosurface_mesh(grid, 35, own_budget(), nullptr, 1)));
  Progress progress;
  progress.cancelled = true;
  CHECK(std::holds_alternative<std::string>(isosurface_mesh(grid, 35, own_budget(), &progress)));
  CHECK(content_of(isosurface_mesh(grid, 500, own_budget()))->empty());
}

TEST_CASE("projects the values of a grid as bytes over the window, from the top row of each slice") {
  qnv::VolumeSource source;
  source.layout.dimensions = {3, 2, 2};
  source.layout.axes = {glm::vec3(2, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 5)};
  source.layout.origin = {7, 0, 0};
  source.layout.type = qnv::VoxelType::f32;
  source.read = [](std::uint32_t z, std::span<std::byte> to) {
    std::vector<float> values;
    for (int i = 0; i < 6; ++i) values.push_back(static_cast<float>(10 * i) + 100 * static_cast<float>(z));
    if (z == 1) values[0] = std::nanf("");
    std::memcpy(to.data(), values.data(), to.size());
    return true;
  };
  const auto grid = grid_of(source);
  ProjectionColors colors{VolumeMode::maximum, std::pair(0.0f, 255.0f), "grey"};
  const auto made = content_of(projection_of(*grid, colors, own_budget()));
  CHECK(made->look->voxels->pixels == std::vector<std::uint8_t>{30, 40, 50, 0, 10, 20, 130, 140, 150, 0, 110, 120});
  CHECK(render::voxel_counts(*made->look->voxels) == std::array<std::uint32_t, 3>{3, 2, 2});
  CHECK(made->look->projection == render::VolumeLook::Projection::maximum);
  CHECK(made->look->dimensions == glm::vec3(6, 2, 10));
  CHECK(made->volume_from_box * glm::dvec4(-0.5, -0.5, -0.5, 1) == glm::dvec4(6, -0.5, -2.5, 1));
  CHECK(made->volume_from_box * glm::dvec4(0.5, 0.5, 0.5, 1) == glm::dvec4(12, 1.5, 7.5, 1));
  const render::Image& table = *made->look->projection_colors;
  CHECK(table.pixels[3] == 0);
  CHECK(table.pixels[4 * 255 + 3] == 255);
  colors = {VolumeMode::minimum, std::nullopt, "viridis"};
  const auto least = content_of(projection_of(*grid, colors, own_budget()));
  CHECK(least->look->voxels->pixels[9] == 255);  // missing
  CHECK(least->look->voxels->pixels[8] == 255);
  CHECK(least->look->voxels->pixels[3] == 0);
  CHECK(least->look->projection_colors->pixels[3] == 255);
  const auto few = content_of(projection_of(*grid, colors, own_budget(), 5));
  CHECK(render::voxel_counts(*few->look->voxels) == std::array<std::uint32_t, 3>{2, 1, 1});
  CHECK(std::holds_alternative<std::string>(projection_of(*grid, colors, no_memory())));
}

TEST_CASE("makes vectors of a share of the voxels") {
  const auto grid = grid_of(ball(21));
  auto found = qnv::gradient_vectors(ball(21), {});
  qnv::Volume& usual = std::get<qnv::Volume>(found);
  usual.description.metadata.emplace_back("title", "ball");
  const double voxels = 21 * 21 * 21;
  for (const float share : {0.02f, 0.3f}) {
    const auto made = content_of(vectors_of_share(grid, usual, share, own_budget()));
    const auto* volume = made->as<qnv::Volume>();
    REQUIRE(volume);
    CHECK(volume->size() == static_cast<std::size_t>(std::round(static_cast<double>(share) * voxels)));
    CHECK(volume->description.value_range == usual.description.value_range);
    CHECK(volume->description.metadata == usual.description.metadata);
    CHECK(volume->description.total == usual.description.total);
  }
  CHECK(std::holds_alternative<std::string>(vectors_of_share(grid, usual, 0.2f, no_memory())));
}

}  // namespace gs::app::volume_derivations_test
