#pragma once

#include "vrml/behaviours/particles/surface_tree.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::vrml {

/// Polylines along which particles start.
struct ParticleLines {
  struct Segment {
    glm::vec3 from{0}, to{0};
    double end = 0;  // length of all segments so far
  };
  std::vector<Segment> segments;
};

/// Emitter of a particle system (X3D clause 40): positions and velocities of new particles, in the coordinate system of
/// the ParticleSystem.
struct ParticleEmitter {
  enum class Kind : std::uint8_t { none, point, cone, explosion, polyline, surface, volume };
  Kind kind = Kind::none;
  bool on = true;
  glm::vec3 position{0};
  glm::vec3 direction{0};  // unit vector, or 0 for all directions
  float angle = 0, speed = 0, variation = 0;
  float mass = 0, surface_area = 0;
  std::shared_ptr<const ParticleLines> lines;
  std::shared_ptr<const SurfaceTree> surface;
  friend bool operator==(const ParticleEmitter&, const ParticleEmitter&) = default;
};

/// Position and velocity of a new particle.
struct NewParticle {
  glm::vec3 position{0}, velocity{0};
};
[[nodiscard]] NewParticle emit(const ParticleEmitter& emitter, ParticleRandom& random);
/// Returns a box with the positions of new particles.
[[nodiscard]] Box positions_of(const ParticleEmitter& emitter);

/// WindPhysicsModel (X3D 40.4.10).
struct ParticleWind {
  glm::vec3 direction{0};  // unit vector, or 0 for a wind that changes its direction all the time
  float speed = 0, gustiness = 0, turbulence = 0;
  friend bool operator==(const ParticleWind&, const ParticleWind&) = default;
};

/// Values of a ParticleSystem, its emitter and its physics models that determine the motion of particles. All numbers
/// are finite and within their ranges.
struct ParticleSettings {
  /// Maximum particles of a system. `maxParticles` may be greater.
  static constexpr std::size_t kMaxParticles = 100'000;
  static constexpr float kShortestLife = 1e-3F, kLongestLife = 1e6F;  // seconds

  ParticleEmitter emitter;
  bool creates = true;
  std::size_t most = 0;
  float lifetime = 0, lifetime_variation = 0;
  glm::vec2 size{0};
  glm::vec3 force{0};  // sum of all ForcePhysicsModels
  std::vector<ParticleWind> winds;
  std::vector<std::shared_ptr<const SurfaceTree>> bounds;
  friend bool operator==(const ParticleSettings&, const ParticleSettings&) = default;

  /// Reports whether the emitter produces new particles, now or all the time.
  [[nodiscard]] bool makes_particles() const {
    return creates && emitter.on && emitter.kind != ParticleEmitter::Kind::none && most > 0 && lifetime > 0;
  }
  /// Reports whether all particles start at once (ExplosionEmitter).
  [[nodiscard]] bool explodes() const { return emitter.kind == ParticleEmitter::Kind::explosion; }
  /// Returns the maximum lifetime of new particles in seconds.
  [[nodiscard]] double longest_life() const { return double{lifetime} * (1 + double{lifetime_variation}); }
};

}  // namespace gs::vrml
