#pragma once

#include "qnv/base/geometry.h"
#include "render/splat/software/splat_raster.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

/// Helpers of tests of splats.
namespace gs::test {

inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Returns a view of 90 degrees from the origin along -z.
inline render::SplatView straight_view(int width, int height) {
  render::SplatView view;
  view.tangents = {static_cast<float>(width) / static_cast<float>(height), 1.0f};
  view.width = width;
  view.height = height;
  view.near_plane = 0.01f;
  return view;
}

/// Returns a view from `eye` to the origin, 53 degrees high.
inline render::SplatView view_from(const glm::vec3& eye, int width, int height) {
  render::SplatView view;
  view.camera_from_node = glm::lookAt(eye, glm::vec3(0), glm::vec3(0.1f, 1, 0.05f));
  view.tangents = {0.5f * static_cast<float>(width) / static_cast<float>(height), 0.5f};
  view.width = width;
  view.height = height;
  view.near_plane = 0.01f;
  return view;
}

/// 10 log10(1 / mean square error) of values in 0..1.
class Psnr {
 public:
  void add(double a, double b) {
    sum_ += (a - b) * (a - b);
    ++count_;
  }
  [[nodiscard]] double decibels() const {
    return sum_ > 0 ? 10 * std::log10(static_cast<double>(count_) / sum_) : 200.0;
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  double sum_ = 0;
  std::size_t count_ = 0;
};

inline void add(qnv::VectorArrays& geometry, const glm::vec3& position, const glm::vec3& normal, float weight) {
  geometry.positions.push_back(position);
  geometry.normals.push_back(normal);
  geometry.weights.push_back(weight);
}

inline glm::vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  const glm::vec3 v(normal(random), normal(random), normal(random));
  return v / std::max(std::sqrt(glm::dot(v, v)), 1e-6f);
}

/// Returns a volume with a white transfer function and one opacity for all classes.
inline qnv::Volume empty_volume(float opacity, float spacing) {
  qnv::Volume geometry;
  geometry.description.spacing = spacing;
  geometry.description.transfer = {{0, {255, 255, 255}, opacity}, {1, {255, 255, 255}, opacity}};
  return geometry;
}

inline void add(qnv::Volume& geometry, const glm::vec3& position, const glm::vec3& normal, float weight,
                std::uint8_t value) {
  add(geometry, position, normal, weight);
  geometry.classes.push_back(value);
}

/// Returns a thick shell of radius about 1, with vectors of all magnitudes and classes.
inline qnv::Volume random_volume(std::size_t count, unsigned seed, float spacing) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> part(0, 1);
  qnv::Volume geometry;
  geometry.description.spacing = spacing;
  geometry.description.transfer = {{0, {255, 60, 20}, 0.02f}, {0.5f, {60, 230, 90}, 0.3f}, {1, {240, 240, 255}, 0.9f}};
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 n = random_direction(random);
    add(geometry, n * (0.7f + 0.3f * part(random)), random_direction(random), 0.1f + part(random),
        static_cast<std::uint8_t>(random() % 256));
  }
  return geometry;
}

/// Returns a sphere of evenly spread discs with the area of the sphere in total.
inline qnv::Splats disc_sphere(std::size_t count, float radius, const glm::vec3& center = glm::vec3(0)) {
  qnv::Splats geometry;
  const auto all = static_cast<float>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float z = 1 - (2 * static_cast<float>(i) + 1) / all, r = std::sqrt(1 - z * z);
    const float turn = static_cast<float>(i) * 2.39996323f;
    const glm::vec3 n(r * std::cos(turn), r * std::sin(turn), z);
    add(geometry, center + n * radius, n, 4 * 3.14159265f * radius * radius / all);
    geometry.colors.push_back(
        {static_cast<std::uint8_t>(i * 255 / count), static_cast<std::uint8_t>(128 + 120 * n.x), 90});
    geometry.description.box.add(geometry.positions.back());
  }
  return geometry;
}

}  // namespace gs::test
