#include "app/encode/surface_triangles.h"

#include "render/scene/render_list.h"
#include "tests/watched.h"

#include <glm/geometric.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <span>
#include <utility>
#include <vector>

namespace gs::app::surface_triangles_test {
namespace {

/// Returns an octahedron with separate corners, each triangle with its own part of a texture of 64 x 64 pixels.
render::RenderList octahedron(const std::vector<glm::vec2>& texture_coordinates, bool round) {
  std::vector<glm::vec3> positions, normals;
  std::vector<std::uint32_t> indices;
  for (int side = 0; side < 8; ++side) {
    const glm::vec3 sign(side & 1 ? -1 : 1, side & 2 ? -1 : 1, side & 4 ? -1 : 1);
    std::array<glm::vec3, 3> corners{glm::vec3(sign.x, 0, 0), glm::vec3(0, sign.y, 0), glm::vec3(0, 0, sign.z)};
    if (sign.x * sign.y * sign.z < 0) std::swap(corners[1], corners[2]);
    const glm::vec3 flat = glm::normalize(sign);
    for (const glm::vec3& p : corners) {
      indices.push_back(static_cast<std::uint32_t>(positions.size()));
      positions.push_back(p);
      normals.push_back(round ? p : flat);
    }
  }
  auto mesh = std::make_shared<vrml::Mesh>();
  mesh->positions = Array<glm::vec3>(std::span<const glm::vec3>(positions));
  mesh->normals = Array<glm::vec3>(std::span<const glm::vec3>(normals));
  mesh->texture_coordinates = Array<glm::vec2>(std::span<const glm::vec2>(texture_coordinates));
  mesh->indices = Array<std::uint32_t>(std::span<const std::uint32_t>(indices));
  auto image = std::make_shared<render::Image>();
  image->width = image->height = 64;
  image->components = 3;
  for (int i = 0; i < 64 * 64; ++i)
    image->pixels.insert(image->pixels.end(), {static_cast<std::uint8_t>(i % 64 * 4), 0, 0});
  render::RenderList list;
  render::DrawItem& item = list.items.emplace_back();
  item.mesh = std::move(mesh);
  item.texture.image = std::move(image);
  return list;
}

std::vector<qnv::Triangle> triangles_of(const render::RenderList& list) {
  std::vector<qnv::Triangle> all;
  REQUIRE(for_each_triangle(list, [&](std::span<const qnv::Triangle> some) {
    all.insert(all.end(), some.begin(), some.end());
    return true;
  }));
  return all;
}

double area_of(const std::vector<qnv::Triangle>& triangles) {
  double area = 0;
  for (const qnv::Triangle& t : triangles)
    area += 0.5 * glm::length(glm::cross(glm::dvec3(t.positions[1] - t.positions[0]),
                                         glm::dvec3(t.positions[2] - t.positions[0])));
  return area;
}

using EdgeEnd = std::array<float, 3>;
/// Checks that each edge has a triangle on both sides, with equal bits.
void check_closed(const std::vector<qnv::Triangle>& triangles) {
  std::map<std::pair<EdgeEnd, EdgeEnd>, int> edges;
  for (const qnv::Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 &a = t.positions[k], &b = t.positions[(k + 1) % 3];
      const EdgeEnd from{a.x, a.y, a.z}, to{b.x, b.y, b.z};
      ++edges[{from, to}];
      --edges[{to, from}];
    }
  for (const auto& [ends, count] : edges) REQUIRE_EACH(count == 0);
}

std::vector<glm::vec2> random_texture_coordinates(unsigned seed, float size) {
  std::mt19937 random(seed);
  std::vector<glm::vec2> coordinates;
  for (int i = 0; i < 24; ++i) {
    const auto part = [&] { return size * static_cast<float>(random() % 1000) / 1000; };
    const float s = part(), t = part();
    coordinates.emplace_back(s, t);
  }
  return coordinates;
}

}  // namespace

TEST_CASE("keeps a textured surface closed, whatever part of the texture its triangles use") {
  for (unsigned seed = 0; seed < 6; ++seed)
    for (const bool round : {false, true}) {
      std::vector<glm::vec2> coordinates = random_texture_coordinates(seed, 0.6f);
      if (seed % 2 == 1)  // alternates sides of few, many and no pixels
        for (std::size_t i = 0; i < coordinates.size(); ++i) coordinates[i] *= static_cast<float>(i / 3 % 3) * 0.4f;
      const std::vector<qnv::Triangle> triangles = triangles_of(octahedron(coordinates, round));
      CHECK(triangles.size() > 100);
      check_closed(triangles);
    }
}

TEST_CASE("divides a flat face inside itself, and bends one by its normals") {
  const std::vector<glm::vec2> coordinates = random_texture_coordinates(7, 0.9f);
  const std::vector<qnv::Triangle> flat = triangles_of(octahedron(coordinates, false));
  CHECK(area_of(flat) == Approx(8 * std::sqrt(3.0) / 2).epsilon(1e-5));
  for (const qnv::Triangle& t : flat)
    for (const glm::vec3& p : t.positions)
      REQUIRE_EACH(std::abs(std::abs(p.x) + std::abs(p.y) + std::abs(p.z) - 1) < 1e-5f);
}

TEST_CASE("bends an edge if its normals turn by less than sixty degrees") {
  // A quarter of a pipe in four strips.
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> coordinates;
  std::vector<std::uint32_t> indices;
  constexpr float kStrip = 3.14159265f / 8;
  for (std::uint32_t i = 0; i <= 4; ++i)
    for (int end = 0; end < 2; ++end) {
      const glm::vec3 n(std::cos(kStrip * static_cast<float>(i)), std::sin(kStrip * static_cast<float>(i)), 0);
      normals.push_back(n);
      positions.push_back(n + glm::vec3(0, 0, end));
      coordinates.emplace_back(static_cast<float>(i) / 4, end);
    }
  for (std::uint32_t i = 0; i < 4; ++i)
    for (const std::uint32_t k : {0u, 2u, 3u, 0u, 3u, 1u}) indices.push_back(2 * i + k);
  render::RenderList list = octahedron(random_texture_coordinates(1, 1), true);
  auto pipe = std::make_shared<vrml::Mesh>();
  pipe->positions = Array<glm::vec3>(std::span<const glm::vec3>(positions));
  pipe->normals = Array<glm::vec3>(std::span<const glm::vec3>(normals));
  pipe->texture_coordinates = Array<glm::vec2>(std::span<const glm::vec2>(coordinates));
  pipe->indices = Array<std::uint32_t>(std::span<const std::uint32_t>(indices));
  list.items[0].mesh = pipe;
  // Straight lines would be up to 1 - cos(11.25 degrees) = 0.019 inside the pipe.
  std::size_t vertices = 0;
  for (const qnv::Triangle& t : triangles_of(list))
    for (const glm::vec3& p : t.positions) {
      REQUIRE_EACH(std::abs(glm::length(glm::vec2(p.x, p.y)) - 1) < 0.004f);
      ++vertices;
    }
  CHECK(vertices > 1000);
}

}  // namespace gs::app::surface_triangles_test
