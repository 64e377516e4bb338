#include "vrml/behaviours/particles/particle_settings.h"

#include <glm/glm.hpp>

#include <algorithm>

// Emitters of particles (X3D 40.4.2, 40.4.3, 40.4.6 to 40.4.9).
namespace gs::vrml {
namespace {

glm::vec3 random_point_on(const ParticleLines& lines, ParticleRandom& random) {
  if (lines.segments.empty()) return {};
  const double wanted = double{random.unit()} * lines.segments.back().end;
  const auto found = std::upper_bound(lines.segments.begin(), lines.segments.end(), wanted,
                                      [](double place, const ParticleLines::Segment& one) { return place < one.end; });
  const ParticleLines::Segment& segment = found == lines.segments.end() ? lines.segments.back() : *found;
  return segment.from + (segment.to - segment.from) * random.unit();
}

}  // namespace

NewParticle emit(const ParticleEmitter& emitter, ParticleRandom& random) {
  NewParticle made{emitter.position, {}};
  const float speed = random.varied(emitter.speed, emitter.variation);
  const bool directed = emitter.direction != glm::vec3(0);
  glm::vec3 direction = directed ? emitter.direction : random.direction();
  switch (emitter.kind) {
    case ParticleEmitter::Kind::none:
    case ParticleEmitter::Kind::point:
      break;
    case ParticleEmitter::Kind::cone:
      if (directed) direction = DirectionCone(emitter.direction, emitter.angle).direction(random);
      break;
    case ParticleEmitter::Kind::explosion:
      direction = random.direction();
      break;
    case ParticleEmitter::Kind::polyline:
      if (emitter.lines) made.position = random_point_on(*emitter.lines, random);
      break;
    case ParticleEmitter::Kind::surface: {
      if (!emitter.surface) break;
      const SurfaceTree::Point start = emitter.surface->random_point(random);
      made.position = start.point;
      direction = emitter.surface->solid() || random.unit() < 0.5F ? start.normal : -start.normal;
      break;
    }
    case ParticleEmitter::Kind::volume:
      if (emitter.surface) made.position = emitter.surface->random_inner_point(random);
      break;
  }
  made.velocity = direction * speed;
  return made;
}

Box positions_of(const ParticleEmitter& emitter) {
  Box box;
  if (emitter.lines) {
    for (const ParticleLines::Segment& segment : emitter.lines->segments) {
      box.add(segment.from);
      box.add(segment.to);
    }
  } else if (emitter.surface) {
    box = emitter.surface->bounds();
  } else if (emitter.kind != ParticleEmitter::Kind::none) {
    box.add(emitter.position);
  }
  return box;
}

}  // namespace gs::vrml
