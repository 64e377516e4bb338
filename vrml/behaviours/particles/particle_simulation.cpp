#include "vrml/behaviours/particles/particle_simulation.h"

#include <glm/glm.hpp>

#include <cmath>
#include <numbers>
#include <optional>

namespace gs::vrml {
namespace {

constexpr double kTick = 1.0 / 30;  // usual length of a tick in seconds
// Maximum number of particles times ticks within a lifetime. Larger systems get longer ticks.
constexpr double kMaxParticleWork = 1 << 24;
constexpr std::uint64_t kBirthNumbers = 1, kWindNumbers = 2;  // purposes of random numbers

constexpr float kMaxAcceleration = 1e9F;

// Returns the pressure of a wind in newtons per square metre (40.4.10): 10^(2 log(speed)) * 0.64615. Like X_ITE, takes
// the natural logarithm, for which existing worlds are made.
float wind_pressure(float speed) {
  return speed > 0 ? std::pow(10.0F, 2 * std::log(std::min(speed, 1e8F))) * 0.64615F : 0;
}

glm::vec3 limited(const glm::vec3& acceleration) {
  return glm::clamp(acceleration, glm::vec3(-kMaxAcceleration), glm::vec3(kMaxAcceleration));
}

}  // namespace

ParticleSimulation::ParticleSimulation(std::uint64_t seed, double start, const ParticleSettings& settings)
    : seed_(seed), start_(start), settings_(settings) {
  longest_ = settings_.longest_life();
  choose_span();
  last_span_ = span_;
  begin_births(0);
}

// Starts a sequence of births at the time `first`.
void ParticleSimulation::begin_births(double first) {
  birth_origin_ = first;
  births_ = 0;
  period_ = double{settings_.lifetime} / static_cast<double>(std::max<std::size_t>(settings_.most, 1));
  const bool endless = settings_.makes_particles() && !settings_.explodes();
  busy_until_ = endless ? std::numeric_limits<double>::infinity()
                        : std::max(first, now_) + 2 * std::max(span_, last_span_) +
                              (particles_.empty() && !settings_.makes_particles() ? 0 : longest_);
}

void ParticleSimulation::choose_span() {
  span_ = std::min(kTick, std::max<double>(settings_.lifetime, ParticleSettings::kShortestLife) / 4);
  const double many = static_cast<double>(std::max(settings_.most, particles_.size()));
  span_ = std::max(span_, std::exp2(std::ceil(std::log2(many * longest_ / kMaxParticleWork / span_ + 1e-9))) * span_);
}

void ParticleSimulation::change(const ParticleSettings& settings) {
  advance();
  const bool continues = settings_.makes_particles() && !settings_.explodes();
  const double end = end_of(tick_), last = birth(births_ - 1);
  double oldest = 0;
  for (const Particle& one : particles_) oldest = std::max(oldest, double{one.lifetime});
  if (!settings.explodes()) exploded_ = false;
  settings_ = settings;
  longest_ = std::max(oldest, settings_.longest_life());
  choose_span();
  grid_ = end;
  tick_ = 0;
  // A new rate applies from the last birth on, so that frequent changes do not delay births.
  const double period = double{settings_.lifetime} / static_cast<double>(std::max<std::size_t>(settings_.most, 1));
  begin_births(continues ? std::max(end, last + period) : end);
}

void ParticleSimulation::advance() {
  if (now_ <= end_of(tick_)) return;
  const double target = std::ceil((now_ - grid_) / span_);
  const double lifetime = std::ceil(longest_ / span_) + 1;
  if (target - tick_ > lifetime) skip_to(target - lifetime);
  while (tick_ < target) step();
}

// Omits ticks before `tick`, because all particles of that time die before the next picture.
void ParticleSimulation::skip_to(double tick) {
  particles_.clear();
  ticks_ += static_cast<std::uint64_t>(tick - tick_);
  tick_ = tick;
  if (!settings_.makes_particles()) return;
  if (settings_.explodes()) {
    next_number_ += exploded_ ? 0 : settings_.most;
    exploded_ = true;
    return;
  }
  const double skipped = std::max(std::ceil((end_of(tick) - birth_origin_) / period_), births_);
  next_number_ += static_cast<std::uint64_t>(skipped - births_);
  births_ = skipped;
}

void ParticleSimulation::step() {
  const double begin = end_of(tick_), end = end_of(tick_ + 1);
  const auto seconds = static_cast<float>(span_);
  turbulences_.clear();
  const glm::vec3 common = forces(turbulences_);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Particle& one = particles_[i];
    if (one.age >= one.lifetime) continue;
    glm::vec3 acceleration = common;
    for (std::size_t k = 0; k < turbulences_.size(); ++k) {
      const Turbulence& turbulence = turbulences_[k];
      ParticleRandom random(seed_ ^ (ticks_ << 20), one.number, kWindNumbers + k);
      acceleration += turbulence.directions.direction(random) * turbulence.acceleration;
    }
    one.from = one.to;
    one.to += (one.velocity + acceleration * (seconds / 2)) * seconds;
    one.velocity += acceleration * seconds;
    if (!settings_.bounds.empty()) rebound(one.from, one.to, one.velocity);
    one.age += seconds;
    if (kept != i) particles_[kept] = one;
    ++kept;
  }
  particles_.resize(kept);
  add_births(begin, end, common);
  ++tick_;
  ++ticks_;
  last_span_ = span_;
}

// Returns the acceleration of all particles during the next tick. Appends the winds that differ between particles.
// Particles without mass are treated as having the mass 1.
glm::vec3 ParticleSimulation::forces(std::vector<Turbulence>& turbulences) const {
  const float mass = settings_.emitter.mass > 0 ? settings_.emitter.mass : 1;
  glm::vec3 sum = limited(settings_.force / mass);
  for (std::size_t i = 0; i < settings_.winds.size(); ++i) {
    const ParticleWind& wind = settings_.winds[i];
    ParticleRandom random(seed_, ticks_, (kWindNumbers + i) << 32);
    const float pressure = wind_pressure(random.varied(wind.speed, wind.gustiness));
    const glm::vec3 direction = wind.direction != glm::vec3(0) ? wind.direction : random.direction();
    const float acceleration = std::min(pressure * settings_.emitter.surface_area / mass, kMaxAcceleration);
    if (wind.turbulence > 0)
      turbulences.push_back({{direction, wind.turbulence * std::numbers::pi_v<float>}, acceleration});
    else
      sum += direction * acceleration;
  }
  return sum;
}

void ParticleSimulation::add_births(double begin, double end, const glm::vec3& acceleration) {
  if (!settings_.makes_particles()) return;
  if (settings_.explodes()) {
    if (exploded_) return;
    exploded_ = true;
    particles_.reserve(settings_.most);
    for (std::size_t i = 0; i < settings_.most; ++i) add(begin, begin, end, acceleration);
    return;
  }
  // After an extremely long time, doubles cannot count the births of such short lives any more.
  for (double time = birth(births_); time < end && births_ + 1 > births_; time = birth(++births_))
    add(time, begin, end, acceleration);
}

void ParticleSimulation::add(double time, double begin, double end, const glm::vec3& acceleration) {
  ParticleRandom random(seed_, next_number_, kBirthNumbers);
  Particle one;
  one.number = next_number_++;
  const NewParticle made = emit(settings_.emitter, random);
  const auto rest = static_cast<float>(end - time), before = static_cast<float>(time - begin);
  one.velocity = made.velocity + acceleration * rest;
  one.to = made.position + (made.velocity + acceleration * (rest / 2)) * rest;
  if (!settings_.bounds.empty()) rebound(made.position, one.to, one.velocity);
  one.from = rest > 0 ? made.position - (one.to - made.position) * (before / rest) : made.position;
  one.age = rest;
  one.lifetime = random.varied(settings_.lifetime, settings_.lifetime_variation);
  one.size = settings_.size;
  particles_.push_back(one);
}

// Reflects a particle that passes through a bounding surface on its way (40.4.1).
void ParticleSimulation::rebound(const glm::vec3& from, glm::vec3& to, glm::vec3& velocity) const {
  constexpr int kMaxRebounds = 4;
  constexpr float kDistance = 1e-4F;  // from the surface after a reflection, relative to the size of the surface
  glm::vec3 start = from;
  for (int i = 0; i < kMaxRebounds; ++i) {
    std::optional<SurfaceTree::Hit> nearest;
    float distance = 0;
    for (const auto& surface : settings_.bounds) {
      const auto hit = surface->first_hit(start, to);
      if (!hit || (nearest && hit->part >= nearest->part)) continue;
      nearest = hit;
      distance = kDistance * glm::length(surface->bounds().size());
    }
    if (!nearest) return;
    const glm::vec3 motion = to - start;
    const glm::vec3 face = glm::dot(nearest->face, motion) < 0 ? nearest->face : -nearest->face;
    glm::vec3 normal = glm::dot(nearest->normal, face) < 0 ? -nearest->normal : nearest->normal;
    // Averaged normals must not reflect particles into the surface.
    if (glm::dot(glm::reflect(motion, normal), face) <= 0) normal = face;
    const glm::vec3 rest = glm::reflect(to - nearest->point, normal);
    if (glm::dot(velocity, normal) < 0) velocity = glm::reflect(velocity, normal);
    start = nearest->point + face * std::min(distance, glm::length(motion) * 0.5F);
    to = start + rest;
  }
  to = start;
}

std::span<const ShownParticle> ParticleSimulation::shown() {
  advance();
  shown_.clear();
  const double part = last_span_ > 0 ? 1 - (end_of(tick_) - now_) / last_span_ : 1;
  const auto at = static_cast<float>(std::clamp(part, 0.0, 1.0));
  const float early = (1 - at) * static_cast<float>(last_span_);
  for (const Particle& one : particles_) {
    if (shown_.size() >= settings_.most) break;
    const float age = one.age - early;
    if (age < 0 || age >= one.lifetime) continue;
    shown_.push_back({one.from + (one.to - one.from) * at, one.velocity, age, one.lifetime, one.size});
  }
  return shown_;
}

Box ParticleSimulation::expected_bounds() const {
  constexpr float kMaxSeconds = 10;
  const ParticleEmitter& emitter = settings_.emitter;
  Box box = positions_of(emitter);
  if (box.empty()) return box;
  const float reach = emitter.speed * std::min(settings_.lifetime, kMaxSeconds);
  const bool directed = emitter.direction != glm::vec3(0) && emitter.kind != ParticleEmitter::Kind::explosion &&
                        emitter.kind != ParticleEmitter::Kind::surface;
  const Box start = box;
  const bool straight = directed && emitter.kind != ParticleEmitter::Kind::cone;
  for (const glm::vec3& corner : {start.lower, start.upper}) {
    if (directed) box.add(corner + emitter.direction * reach);
    const float around = (straight   ? 0
                          : directed ? reach * std::sin(std::min(emitter.angle, 1.57F))
                                     : reach) +
                         std::max(settings_.size.x, settings_.size.y) / 2;
    box.add(corner - glm::vec3(around));
    box.add(corner + glm::vec3(around));
  }
  return box;
}

}  // namespace gs::vrml
