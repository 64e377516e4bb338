#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>

namespace gs::vrml {

/// Sequence of random numbers that depends only on three numbers, so that a particle system looks the same in each run.
class ParticleRandom {
 public:
  /// `seed` identifies the system, `number` the particle, and `purpose` the use of the numbers.
  ParticleRandom(std::uint64_t seed, std::uint64_t number, std::uint64_t purpose = 0)
      : state_(mixed(mixed(seed + number * kStep) ^ (purpose * kStep + 1))) {}

  /// Returns a number in [0, 1).
  float unit() {
    state_ += kStep;
    return static_cast<float>(mixed(state_) >> 40) * 0x1p-24F;
  }
  /// Returns a number in [-1, 1).
  float around() { return 2 * unit() - 1; }
  /// Returns a value that differs from `value` by at most `variation` times `value`, and is at least 0.
  float varied(float value, float variation) { return std::fmax(value * (1 + variation * around()), 0.0F); }
  /// Returns a point on the part of the unit sphere with z >= `lowest`. All points are equally likely.
  glm::vec3 on_cap(float lowest) {
    const float turn = unit() * 2 * std::numbers::pi_v<float>, z = 1 - unit() * (1 - lowest);
    const float radius = std::sqrt(std::fmax(1 - z * z, 0.0F));
    return {std::cos(turn) * radius, std::sin(turn) * radius, z};
  }
  /// Returns a unit vector. All directions are equally likely.
  glm::vec3 direction() { return on_cap(-1); }

 private:
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15;

  // Finalizer of SplitMix64.
  static constexpr std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EB;
    return x ^ (x >> 31);
  }
  std::uint64_t state_;
};

/// Directions that differ from an axis by at most an angle.
class DirectionCone {
 public:
  /// `axis` is a unit vector; `angle` is in radians.
  DirectionCone(const glm::vec3& axis, float angle)
      : axis_(axis), lowest_(std::cos(std::fmin(std::fmax(angle, 0.0F), std::numbers::pi_v<float>))) {
    right_ = glm::normalize(glm::cross(std::abs(axis.x) < 0.7F ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0), axis));
    up_ = glm::cross(axis_, right_);
  }
  /// Returns a unit vector. All directions of the cone are equally likely.
  glm::vec3 direction(ParticleRandom& random) const {
    const glm::vec3 local = random.on_cap(lowest_);
    return right_ * local.x + up_ * local.y + axis_ * local.z;
  }

 private:
  glm::vec3 axis_, right_, up_;
  float lowest_;
};

}  // namespace gs::vrml
