#pragma once

// Splats for tests, and an OpenGL context without a window.

#include "qnv/base/geometry.h"
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/records/record.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/stream_decoder.h"
#include "render/gl/gl.h"
#include "tests/geometries.h"
#include "tests/render/drawing.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace gs::render::testing {

inline constexpr float kPi = 3.14159265f;

/// Returns splats of equal area along a spiral on a unit sphere.
inline std::shared_ptr<qnv::Splats> sphere(std::size_t count, bool colored = false) {
  auto geometry = std::make_shared<qnv::Splats>();
  for (std::size_t i = 0; i < count; ++i) {
    const float z = 1 - 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    const float angle = 2.3999632f * static_cast<float>(i), across = std::sqrt(1 - z * z);
    const glm::vec3 n(across * std::cos(angle), across * std::sin(angle), z);
    geometry->positions.push_back(n);
    geometry->normals.push_back(n);
    geometry->weights.push_back(4 * kPi / static_cast<float>(count));
    const auto level = [](float c) { return static_cast<std::uint8_t>(std::lround((c * 0.5f + 0.5f) * 255)); };
    if (colored) geometry->colors.push_back({level(n.x), level(n.y), level(-n.z)});
  }
  geometry->description.box = {{-1, -1, -1}, {1, 1, 1}};
  return geometry;
}

inline std::vector<std::byte> octree_of(const std::vector<qnv::Triangle>& triangles, std::size_t vectors) {
  qnv::EncodeOptions options;
  options.vectors = vectors;
  auto encoded =
      qnv::encode_surface([&](const qnv::TriangleSink& sink) { return sink(std::span(triangles)); }, options);
  if (auto* error = std::get_if<qnv::EncodeError>(&encoded)) FAIL(error->message);
  return std::move(std::get<qnv::EncodedStream>(encoded).bytes);
}

/// Returns the sphere as an octree stream, with splats clipped to its cubes.
inline std::shared_ptr<const qnv::Splats> octree_sphere(std::size_t vectors) {
  const auto on_sphere = [](int row, int column) {
    const float theta = kPi * static_cast<float>(row) / 24, phi = kPi * static_cast<float>(column) / 24;
    return glm::vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
  };
  std::vector<qnv::Triangle> triangles;
  const auto add = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    qnv::Triangle triangle;
    triangle.positions = {a, b, c};
    triangle.normals = {glm::normalize(a), glm::normalize(b), glm::normalize(c)};
    triangle.colors.fill({200, 120, 60});
    triangles.push_back(triangle);
  };
  for (int row = 0; row < 24; ++row)
    for (int column = 0; column < 48; ++column) {
      const glm::vec3 a = on_sphere(row, column), b = on_sphere(row + 1, column), c = on_sphere(row + 1, column + 1),
                      d = on_sphere(row, column + 1);
      if (row < 23) add(a, b, c);
      if (row > 0) add(a, c, d);
    }
  qnv::StreamDecoder decoder;
  REQUIRE(decoder.push(octree_of(triangles, vectors)));
  decoder.finish();
  return std::make_shared<const qnv::Splats>(content_of<qnv::Splats>(decoder.geometry()));
}

/// Returns a closed, bumpy surface at 0.94 to 1.06 from the origin, as an octree stream with levels.
inline std::shared_ptr<const qnv::Geometry> bumpy_stream(std::size_t vectors) {
  constexpr int kRows = 160;
  const auto on_surface = [](int row, int column) {
    const float theta = kPi * static_cast<float>(row) / kRows, phi = kPi * static_cast<float>(column) / kRows;
    const glm::vec3 n(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
    return n * (1 + 0.02f * (std::sin(20 * n.x) + std::sin(20 * n.y) + std::sin(20 * n.z)));
  };
  std::vector<qnv::Triangle> triangles;
  const auto add = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    qnv::Triangle triangle;
    triangle.positions = {a, b, c};
    triangle.normals.fill(glm::normalize(glm::cross(b - a, c - a)));
    triangles.push_back(triangle);
  };
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < 2 * kRows; ++column) {
      const glm::vec3 a = on_surface(row, column), b = on_surface(row + 1, column), c = on_surface(row + 1, column + 1),
                      d = on_surface(row, column + 1);
      if (row + 1 < kRows) add(a, b, c);
      if (row > 0) add(a, c, d);
    }
  auto opened = qnv::LodStream::open(octree_of(triangles, vectors));
  if (auto* problem = std::get_if<qnv::StreamProblem>(&opened)) FAIL(problem->message);
  return std::make_shared<const qnv::Geometry>(
      qnv::OctreeSplats(std::move(std::get<std::unique_ptr<qnv::LodStream>>(opened))));
}

/// OpenGL context on OSMesa.
struct OpenContext {
  OpenContext() {
    context = open_test_context();
    auto loaded = Gl::load(*context);
    if (auto* error = std::get_if<ContextError>(&loaded)) FAIL(error->message);
    gl = std::move(std::get<Gl>(loaded));
  }
  std::unique_ptr<GlContext> context;
  Gl gl;
};

}  // namespace gs::render::testing
