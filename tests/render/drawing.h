#pragma once

// Helpers of tests that draw: small meshes, an OSMesa renderer, pixels.

#include "render/draw/renderer.h"

#include <catch2/catch.hpp>
#include <glm/glm.hpp>

#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>

namespace gs::render::testing {

/// Returns a square of side 2 * `half` in the plane z = 0 that faces +Z, with s and t from 0 to 1.
inline std::shared_ptr<vrml::Mesh> square(float half = 1) {
  auto mesh = std::make_shared<vrml::Mesh>();
  for (const auto& [x, y] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
    mesh->positions.push_back({x * half, y * half, 0});
    mesh->normals.push_back({0, 0, 1});
    mesh->texture_coordinates.push_back({x * 0.5f + 0.5f, y * 0.5f + 0.5f});
    mesh->bounds.add({x * half, y * half, 0});
  }
  mesh->indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

inline glm::mat4 translation(const glm::vec3& by) {
  glm::mat4 matrix(1.0f);
  matrix[3] = glm::vec4(by, 1);
  return matrix;
}

inline glm::mat4 scale(const glm::vec3& by) {
  glm::mat4 matrix(1.0f);
  for (int i = 0; i < 3; ++i) matrix[i][i] = by[i];
  return matrix;
}

inline DrawItem unlit(std::shared_ptr<const vrml::Mesh> mesh, const glm::mat4& world_from_node = glm::mat4(1.0f)) {
  DrawItem item;
  item.mesh = std::move(mesh);
  item.world_from_node = world_from_node;
  item.material.lit = false;
  item.material.diffuse = glm::vec3(1);
  return item;
}

/// Returns a lit item that shows `color` in any light.
inline DrawItem glowing(std::shared_ptr<const vrml::Mesh> mesh, const glm::vec3& color,
                        const glm::mat4& world_from_node = glm::mat4(1.0f)) {
  DrawItem item;
  item.mesh = std::move(mesh);
  item.world_from_node = world_from_node;
  item.material.diffuse = glm::vec3(0);
  item.material.emissive = color;
  return item;
}

inline void add(RenderList& list, DrawItem item) {
  for (int i = 0; i < 8; ++i) {
    const Box& b = item.mesh->bounds;
    const glm::vec4 corner(i & 1 ? b.upper.x : b.lower.x, i & 2 ? b.upper.y : b.lower.y, i & 4 ? b.upper.z : b.lower.z,
                           1);
    list.bounds.add(glm::vec3(item.world_from_node * corner));
  }
  list.items.push_back(std::move(item));
}

inline Camera camera_at(const glm::vec3& eye) {
  Camera camera;
  camera.world_from_camera = translation(eye);
  return camera;
}

/// Opens the context of the tests: OSMesa, or the backend that the environment names (GHOSTSPACE_TEST_BACKEND).
inline std::unique_ptr<GlContext> open_test_context() {
  const char* backend = std::getenv("GHOSTSPACE_TEST_BACKEND");
  auto opened = open_headless_context(backend ? backend : "osmesa");
  if (auto* error = std::get_if<ContextError>(&opened)) FAIL(error->message);
  return std::move(std::get<std::unique_ptr<GlContext>>(opened));
}

/// Renderer on the context of the tests. Without it, the test fails: GhostSpace requires OSMesa.
class Drawing {
 public:
  Drawing() {
    context_ = open_test_context();
    auto made = Renderer::create(*context_);
    if (auto* error = std::get_if<ContextError>(&made)) FAIL(error->message);
    renderer_ = std::move(std::get<std::unique_ptr<Renderer>>(made));
    options.width = options.height = 64;
    options.samples = 1;
  }
  Image draw(const RenderList& list, const Camera& camera = camera_at({0, 0, 10})) {
    auto drawn = renderer_->draw_to_image(list, camera, options, &statistics);
    if (auto* error = std::get_if<ContextError>(&drawn)) FAIL(error->message);
    return std::move(std::get<Image>(drawn));
  }
  Renderer& renderer() { return *renderer_; }
  GlContext& context() { return *context_; }

  DrawOptions options;
  FrameStatistics statistics;

 private:
  std::unique_ptr<GlContext> context_;
  std::unique_ptr<Renderer> renderer_;
};

/// Returns a pixel in 0..255, with row 0 at the top.
inline glm::vec3 pixel(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* p = image.pixels.data() + (std::size_t{y} * image.width + x) * image.components;
  return {p[0], p[1], p[2]};
}

/// Checks that a pixel is within `tolerance` steps of 1/255 of a colour in 0..1.
inline void check_color(const glm::vec3& drawn, const glm::vec3& expected, float tolerance = 1.01f) {
  const glm::vec3 wanted = glm::clamp(expected, 0.0f, 1.0f) * 255.0f;
  INFO("drawn " << drawn.x << " " << drawn.y << " " << drawn.z << ", expected " << wanted.x << " " << wanted.y << " "
                << wanted.z);
  CHECK(std::abs(drawn.x - wanted.x) <= tolerance);
  CHECK(std::abs(drawn.y - wanted.y) <= tolerance);
  CHECK(std::abs(drawn.z - wanted.z) <= tolerance);
}

}  // namespace gs::render::testing
