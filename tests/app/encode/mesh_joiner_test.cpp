#include "app/encode/mesh_joiner.h"

#include <catch2/catch.hpp>

using namespace gs;
using namespace gs::app;

namespace {

qnv::Triangle triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, qnv::Rgb8 color = {9, 8, 7}) {
  qnv::Triangle made;
  made.positions = {a, b, c};
  made.colors = {color, color, color};
  return made;
}

}  // namespace

TEST_CASE("joins corners that are equal in all properties") {
  MeshJoiner joiner;
  joiner.add(triangle({0, 0, 0}, {1, 0, 0}, {1, 1, 0}));
  joiner.add(triangle({0, 0, -0.0f}, {1, 1, 0}, {0, 1, 0}));
  joiner.add(triangle({0, 0, 0}, {1, 1, 0}, {2, 2, 0}));  // no area
  const qnv::IndexedMesh mesh = joiner.take();
  CHECK(mesh.size() == 4);
  CHECK(mesh.triangles == std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3});
  CHECK(mesh.normals[0] == glm::vec3(0, 0, 1));
  CHECK(mesh.colors.empty());
  CHECK(mesh.color == qnv::Rgb8{9, 8, 7});
  CHECK(mesh.description.total == Approx(1));
  float area = 0;
  for (const float weight : mesh.weights) area += weight;
  CHECK(area == Approx(1));
}

TEST_CASE("keeps the colours of faces and the seams of textures apart") {
  MeshJoiner joiner;
  joiner.add(triangle({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {255, 0, 0}));
  joiner.add(triangle({0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 255}));
  qnv::IndexedMesh mesh = joiner.take();
  CHECK(mesh.size() == 6);
  CHECK(mesh.colors.size() == 6);
  CHECK(joiner.triangles() == 0);
  joiner.add(triangle({0, 0, 0}, {1, 0, 0}, {1, 1, 0}), {{glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1)}});
  joiner.add(triangle({0, 0, 0}, {1, 1, 0}, {0, 1, 0}), {{glm::vec2(0, 0), glm::vec2(0.5f, 1), glm::vec2(0, 1)}});
  mesh = joiner.take();
  CHECK(mesh.size() == 5);
  CHECK(mesh.texture_coordinates.size() == 5);
  CHECK(mesh.first_textured() == 0);
}
