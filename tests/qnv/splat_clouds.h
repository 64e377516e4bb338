#pragma once

#include "qnv/base/geometry.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

namespace gs::test {

/// Returns Gaussians on a sphere with stripes of colours, and a thin line through it.
inline qnv::Gaussians splat_cloud(std::size_t count, int degree = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  const auto number = [&](float least, float most) {
    return least + (most - least) * static_cast<float>(random() >> 8) / 16777216.0f;
  };
  qnv::Gaussians all;
  all.degree = degree;
  all.description.two_sided = true;
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec3 at(number(-1, 1), number(-1, 1), number(-1, 1));
    const bool line = i % 10 == 9;
    const float length = std::sqrt(at.x * at.x + at.y * at.y + at.z * at.z) + 1e-3f;
    at = line ? glm::vec3(4 * static_cast<float>(i) / static_cast<float>(count) - 2, 0, 0) : at / length;
    glm::vec4 turn(number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1));
    turn = line ? glm::vec4(0, 0, 0, 1)
                : turn / std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z + turn.w * turn.w + 1e-9f);
    all.positions.push_back(at);
    all.rotations.push_back(turn);
    all.scales.push_back(line ? glm::vec3(0.05f, 0.002f, 0.002f)
                              : glm::vec3(number(0.01f, 0.05f), number(0.01f, 0.03f), number(0.001f, 0.01f)));
    all.opacities.push_back(number(0.02f, 1));
    all.bases.push_back(line ? glm::vec3(1, 0, 0)
                             : glm::vec3(0.5f + 0.4f * std::sin(7 * at.x), 0.5f, 0.5f + 0.4f * std::cos(5 * at.y)));
    for (std::size_t k = 0; k < qnv::harmonic_count(degree); ++k)
      all.harmonics.emplace_back(number(-0.2f, 0.2f), number(-0.2f, 0.2f), 0.1f * at.z);
    all.normals.emplace_back(0, 0, 1);
    all.weights.push_back(2 * std::numbers::pi_v<float> * all.scales[i].x * all.scales[i].y);
    all.colors.push_back({});
    all.description.box.add(at);
    all.description.total += all.weights.back();
  }
  return all;
}

}  // namespace gs::test
