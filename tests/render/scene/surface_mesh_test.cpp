#include "render/scene/surface_mesh.h"

#include "qnv/base/shine.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

namespace gs::render::surface_mesh_test {
namespace {

/// Returns two triangles, the second one textured.
qnv::IndexedMesh half_pictured() {
  qnv::IndexedMesh geometry;
  geometry.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 5}, {1, 1, 5}, {0, 1, 5}};
  geometry.normals.assign(6, glm::vec3(0, 0, 1));
  geometry.weights.assign(6, 1.0f);
  geometry.colors.assign(6, {51, 102, 255});
  geometry.triangles = {0, 1, 2, 3, 4, 5};
  geometry.texture_coordinates = {{0, 0}, {1, 1}, {0, 1}};
  return geometry;
}

}  // namespace

TEST_CASE("makes separate meshes of textured and coloured triangles") {
  const qnv::IndexedMesh geometry = half_pictured();
  const auto plain = mesh_of_surface(geometry), pictured = mesh_of_surface(geometry, true);
  REQUIRE(plain->positions.size() == 3);
  CHECK(plain->colors[0].g == Approx(0.4));
  CHECK(plain->texture_coordinates.empty());
  CHECK(plain->bounds.upper.z == 0);
  REQUIRE(plain->indices.size() == 3);
  CHECK(plain->indices[2] == 2);
  REQUIRE(pictured->positions.size() == 3);
  CHECK(pictured->positions[0] == glm::vec3(0, 0, 5));
  CHECK(pictured->colors.empty());
  CHECK(pictured->texture_coordinates[1] == glm::vec2(1, 1));
  REQUIRE(pictured->indices.size() == 3);
  CHECK(pictured->indices[0] == 0);
  CHECK(pictured->bounds.lower.z == 5);
}

TEST_CASE("makes one mesh of a surface without a texture") {
  qnv::IndexedMesh geometry = half_pictured();
  geometry.texture_coordinates.clear();
  CHECK(mesh_of_surface(geometry)->indices.size() == 6);
  CHECK(mesh_of_surface(geometry, true)->indices.empty());
}

TEST_CASE("reads the shininess of a surface from the stream's metadata") {
  const qnv::Shine shine{{0.25f, 0.5f, 1}, 0.125f};
  qnv::Description description;
  description.metadata = metadata_of(shine);
  CHECK(description.metadata.size() == 2);
  CHECK(shine_of(description) == shine);
  CHECK(metadata_of(qnv::Shine{}).empty());
  CHECK(qnv::shine_of({}) == qnv::Shine{});
  for (const std::string text :
       {"", "1", "0.1 0.2", "0.1 0.2 1.5", "0.1 0.2 -1", "a b c", "0.1 0.2 0.3 0.4", "nan nan nan"}) {
    INFO(text);
    description.metadata = {{"specular", text}, {"shininess", text == "1" ? "x" : text}};
    CHECK(shine_of(description) == qnv::Shine{});
  }
}

TEST_CASE("draws a surface without a Material in the stream's colour and shininess") {
  DrawItem item;
  item.material.lit = false;
  auto geometry = std::make_shared<qnv::Geometry>(half_pictured());
  geometry->base().color = {255, 0, 51};
  geometry->base().description.metadata = qnv::metadata_of(qnv::Shine{{0.5f, 0.5f, 0.5f}, 0.75f});
  item.surface = geometry;
  dress_surface(item);
  CHECK(item.material.lit);
  CHECK(item.material.diffuse == glm::vec3(1, 0, 0.2f));
  CHECK(item.material.specular == glm::vec3(0.5f));
  CHECK(item.material.shininess == 0.75f);
  DrawItem given;
  given.material.lit = true;
  given.material.diffuse = glm::vec3(0.1f);
  given.surface = geometry;
  dress_surface(given);
  CHECK(given.material.diffuse == glm::vec3(0.1f));
  CHECK(given.material.specular == glm::vec3(0));
}

}  // namespace gs::render::surface_mesh_test
