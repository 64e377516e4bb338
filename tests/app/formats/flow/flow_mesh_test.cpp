#include "app/formats/flow/flow_mesh.h"

#include "app/formats/common/dataset_list.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>

namespace gs::app::flow_test {
namespace {

using Flow = std::function<glm::vec3(const glm::dvec3& place)>;

/// Volume of n^3 vectors about the origin, with voxels at distances of 1.
qnv::VolumeSource vector_volume(std::uint32_t n, const Flow& flow, std::size_t components = 3) {
  qnv::VolumeSource source;
  source.layout.dimensions = {n, n, n};
  source.layout.type = qnv::VoxelType::f32;
  source.layout.origin = glm::dvec3(-(static_cast<double>(n) - 1) / 2);
  source.layout.metadata = {{"title", "wind"}, {"units", "m/s"}};
  const glm::dvec3 origin = source.layout.origin;
  for (std::size_t c = 0; c < components; ++c) {
    qnv::VolumeSource one;
    one.layout = source.layout;
    one.read = [=](std::uint32_t z, std::span<std::byte> to) {
      for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) {
          const float value = flow(origin + glm::dvec3(x, y, z))[static_cast<int>(c)];
          std::memcpy(to.data() + (std::size_t{y} * n + x) * sizeof value, &value, sizeof value);
        }
      return true;
    };
    source.components.push_back(one);
  }
  source.read = source.components.front().read;
  return source;
}

glm::vec3 vortex(const glm::dvec3& place) { return {-place.y, place.x, 0}; }

VectorField field_of(const qnv::VolumeSource& source, std::uint64_t most = VectorField::kMaxVectors) {
  auto read = VectorField::read(source, own_budget(), Progress(), most);
  REQUIRE(std::holds_alternative<VectorField>(read));
  return std::get<VectorField>(std::move(read));
}

MeshAsset mesh_of(const qnv::VolumeSource& source, FlowForm form, Diagnostics& diagnostics) {
  VoxelComponent choice;
  choice.flow = form;
  choice.found = std::make_shared<DatasetList>();
  return flow_mesh(source, choice, "wind", Progress(), own_budget(), diagnostics);
}

}  // namespace

TEST_CASE("interpolates vectors between voxels, and thins large volumes") {
  const VectorField field = field_of(vector_volume(9, vortex));
  const auto vector = field.interpolated({4.5, 6.25, 3});
  REQUIRE(vector);
  CHECK(glm::distance(*vector, glm::dvec3(-2.25, 0.5, 0)) < 1e-6);
  CHECK(glm::distance(field.position({0, 0, 0}), glm::dvec3(-4)) < 1e-9);
  CHECK_FALSE(field.interpolated({8.5, 0, 0}));
  CHECK_FALSE(field.interpolated({-0.1, 0, 0}));
  const VectorField thin = field_of(vector_volume(9, vortex), 200);
  CHECK(thin.size() == std::array<std::uint32_t, 3>{5, 5, 5});
  CHECK(thin.spacing() == Approx(2));
  CHECK(glm::distance(thin.position({4, 4, 4}), glm::dvec3(4)) < 1e-9);
}

TEST_CASE("follows a vortex in circles, each at its own radius") {
  const auto lines = streamlines_of(field_of(vector_volume(17, vortex)));
  CHECK(lines.size() > 20);
  for (const Streamline& line : lines) {
    const double radius = glm::length(glm::dvec2(line.points.front()));
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      CHECK(std::abs(glm::length(glm::dvec2(line.points[i])) - radius) < 0.02 * radius + 1e-3);
      CHECK(std::abs(line.points[i].z - line.points.front().z) < 1e-9);
      CHECK(glm::length(line.vectors[i]) == Approx(radius).epsilon(0.03));
    }
  }
}

TEST_CASE("ends streamlines at the border and at missing values") {
  const auto straight = [](const glm::dvec3&) { return glm::vec3(3, 0, 0); };
  for (const Streamline& line : streamlines_of(field_of(vector_volume(9, straight)))) {
    CHECK(line.points.front().x < -3.4);
    CHECK(line.points.back().x > 3.4);
    CHECK(line.points.back().y == Approx(line.points.front().y).margin(1e-9));
  }
  const auto with_gap = [](const glm::dvec3& place) {
    return place.x > 0 ? glm::vec3(std::numeric_limits<float>::quiet_NaN()) : glm::vec3(1, 0, 0);
  };
  for (const Streamline& line : streamlines_of(field_of(vector_volume(9, with_gap)))) CHECK(line.points.back().x <= 0);
}

TEST_CASE("makes arrows and tubes with colours for lengths of vectors") {
  for (const FlowForm form : {FlowForm::arrows, FlowForm::streamlines}) {
    Diagnostics diagnostics;
    const MeshAsset mesh = mesh_of(vector_volume(17, vortex), form, diagnostics);
    CHECK(diagnostics.entries().empty());
    REQUIRE(mesh.parts.size() == 1);
    const Geometry& geometry = mesh.parts[0].geometry;
    CHECK(geometry.positions.size() == geometry.colors.size());
    CHECK(geometry.positions.size() == geometry.normals.size());
    for (std::size_t i = 0; i < geometry.positions.size(); ++i) {
      const glm::vec3& place = geometry.positions[i];
      CHECK(std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}) < 10);  // half an arrow is outside
      CHECK(glm::length(geometry.normals[i]) == Approx(1).margin(1e-3));
    }
    REQUIRE(mesh.color_key);
    CHECK(mesh.color_key->title == "wind (length) (m/s)");
    CHECK(mesh.color_key->low >= 0);
    CHECK(mesh.color_key->high <= 8 * std::sqrt(2.0) + 1e-3);
    CHECK(mesh.color_key->high > 5);
  }
}

TEST_CASE("refuses arrows for voxels of one number") {
  Diagnostics diagnostics;
  CHECK(mesh_of(vector_volume(5, vortex, 1), FlowForm::arrows, diagnostics).empty());
  REQUIRE(diagnostics.errors() == 1);
  CHECK(diagnostics.entries()[0].message == "arrows and streamlines need vectors; its voxels have one number");
}

}  // namespace gs::app::flow_test
