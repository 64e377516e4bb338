#pragma once

// Gaussians for tests.

#include "qnv/base/geometry.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

namespace gs::test {

/// Returns Gaussians of all shapes around the origin.
inline qnv::Gaussians random_gaussians(std::size_t count, int degree, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> even(0, 1);
  qnv::Gaussians made;
  made.degree = degree;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec4 q(normal(random), normal(random), normal(random), normal(random));
    made.positions.push_back(glm::vec3(normal(random), normal(random), normal(random)) * 0.4f);
    made.scales.push_back(glm::vec3(even(random), even(random), even(random) * 0.3f) * 0.12f);
    made.rotations.push_back(q / glm::length(q));
    made.opacities.push_back(even(random));
    made.bases.push_back({even(random), even(random), even(random)});
    for (std::size_t k = 0; k < qnv::harmonic_count(degree); ++k)
      made.harmonics.push_back(glm::vec3(normal(random), normal(random), normal(random)) * 0.1f);
    made.normals.push_back({0, 0, 1});
    made.weights.push_back(1);
  }
  return made;
}

/// Returns 12 Gaussians with harmonics of degree 3, most of them with numbers that are not finite or not possible.
inline qnv::Gaussians hostile_gaussians() {
  qnv::Gaussians made = random_gaussians(12, 3, 2);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  made.positions[1].x = nan;
  made.positions[2].z = infinite;
  made.scales[3].x = infinite;
  made.scales[4] = glm::vec3(1e30f);
  made.rotations[5] = glm::vec4(0);
  made.opacities[6] = nan;
  made.opacities[7] = 1e30f;
  made.bases[8].y = nan;
  made.harmonics[9 * 15].x = infinite;
  made.positions[10] = glm::vec3(1e30f);
  return made;
}

}  // namespace gs::test
