#pragma once

#include "vrml/behaviours/particles/particle_settings.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace gs::vrml {

/// Particle at the time of a picture.
struct ShownParticle {
  glm::vec3 position{0}, velocity{0};
  float age = 0, lifetime = 0;  // seconds
  glm::vec2 size{0};
};

/// Particles of one active ParticleSystem (X3D 40.4.5).
///
/// Time advances in ticks of fixed length; positions between two ticks are interpolated. Ticks run only when particles
/// are shown, so hidden systems cost nothing. All random numbers are functions of the seed and of numbers of particles
/// and ticks. So the particles at a time depend only on the settings until then, not on the times of pictures. The work
/// after any pause is limited, because only the last lifetime before a picture matters.
class ParticleSimulation {
 public:
  /// Starts at the time `start`, in seconds. `settings` apply from then on.
  ParticleSimulation(std::uint64_t seed, double start, const ParticleSettings& settings);

  /// Sets the time of the next picture. An earlier time than before has no effect.
  void pass_to(double now) { now_ = std::max(now_, now - start_); }
  /// Changes the settings. They apply from the present time on.
  void change(const ParticleSettings& settings);

  /// Reports whether later pictures may differ: particles exist or will exist.
  [[nodiscard]] bool is_busy() const { return now_ < busy_until_; }
  /// Returns a number that differs for different pictures.
  [[nodiscard]] double moment() const { return std::min(now_, busy_until_); }
  [[nodiscard]] const ParticleSettings& settings() const { return settings_; }

  /// Returns the particles at the present time, the oldest first, at most ParticleSettings::most. Valid until the next
  /// call.
  [[nodiscard]] std::span<const ShownParticle> shown();
  /// Returns a box that particles will probably not leave soon, for views of the whole world.
  [[nodiscard]] Box expected_bounds() const;

 private:
  struct Particle {
    glm::vec3 from{0}, to{0}, velocity{0};  // positions at both ends of the last tick
    float age = 0, lifetime = 0;            // at the end of the last tick
    glm::vec2 size{0};
    std::uint64_t number = 0;
  };
  /// Wind that acts on each particle in another direction.
  struct Turbulence {
    DirectionCone directions;
    float acceleration = 0;
  };

  [[nodiscard]] double end_of(double tick) const { return grid_ + tick * span_; }
  [[nodiscard]] double birth(double number) const { return birth_origin_ + number * period_; }
  void begin_births(double first);
  void choose_span();
  void advance();
  void skip_to(double tick);
  void step();
  [[nodiscard]] glm::vec3 forces(std::vector<Turbulence>& turbulences) const;
  void add_births(double begin, double end, const glm::vec3& acceleration);
  void add(double time, double begin, double end, const glm::vec3& acceleration);
  void rebound(const glm::vec3& from, glm::vec3& to, glm::vec3& velocity) const;

  std::uint64_t seed_;
  double start_;
  double now_ = 0;  // seconds since the start, as are all further times
  double busy_until_ = std::numeric_limits<double>::infinity();
  ParticleSettings settings_;
  // Ticks end at grid_ + n * span_. tick_ ticks of this grid are done, and ticks_ of all grids. last_span_ is the
  // length of the last tick.
  double grid_ = 0, span_ = 1, tick_ = 0, last_span_ = 1;
  std::uint64_t ticks_ = 0;
  // Births are at birth_origin_ + n * period_; the next one is number births_. Particles are numbered from 0.
  double birth_origin_ = 0, period_ = 1, births_ = 0;
  std::uint64_t next_number_ = 0;
  bool exploded_ = false;
  double longest_ = 0;  // maximum lifetime of particles that may exist
  std::vector<Particle> particles_;
  std::vector<Turbulence> turbulences_;
  std::vector<ShownParticle> shown_;
};

}  // namespace gs::vrml
