#include "vrml/behaviours/particles/particle_nodes.h"
#include "vrml/behaviours/particles/particle_simulation.h"
#include "vrml/event_model/behaviour.h"
#include "vrml/events/execution.h"

#include <algorithm>
#include <memory>
#include <utility>

// ParticleSystem (X3D 40.4.5): activity, and the passing of values and time to the simulation.
namespace gs::vrml {

/// Particles of an active system, and the nodes that they depend on.
struct RunningParticles {
  ParticleNodes nodes;
  std::shared_ptr<ParticleSimulation> simulation;
};

namespace {

// Indices of the events of a ParticleSystem.
struct ParticleEvents {
  enum : int { enabled, is_active, emitter };
};

void begin_particles(Execution& execution, EventNode node) {
  StatePool<ParticleState>& states = execution.states().particles;
  if (!states.has_spare() && !execution.budget().afford(sizeof(ParticleState))) return;
  execution.nodes().state_of(node) = states.take();
  execution.timers().look_again(node);
}

void end_particles(Execution& execution, EventNode node) {
  const NodePlace at = execution.nodes().place_of(node);
  if (at.scene) at.scene->particles().set(at.node, nullptr);
  execution.states().particles.give_back(execution.nodes().state_of(node));
}

// Marks the system as changed, so that pictures show its present particles.
void mark_particles(Execution& execution, EventNode node) {
  if (const InterfaceDeclaration* const field = execution.nodes().type_of(node).find_field("maxParticles"))
    execution.changes().mark(node, field->slot);
}

// Starts the system at its local time zero (40.4.5).
void start_particles(Execution& execution, EventNode node, RunningParticles& running,
                     const ParticleSettings& settings) {
  const NodePlace at = execution.nodes().place_of(node);
  // For a still picture, the system starts earlier: so that it shows all its particles, or an explosion in its course.
  const double before = !execution.states().particles_ahead ? 0
                        : settings.explodes()               ? double{settings.lifetime} / 4
                                                            : double{settings.lifetime};
  running.simulation = std::make_shared<ParticleSimulation>(at.node.index, execution.now() - before, settings);
  at.scene->particles().set(at.node, running.simulation);
}

void run_particles(Execution& execution, EventNode node) {
  const std::uint32_t place = execution.nodes().state_of(node);
  if (place == 0) return;
  ParticleState& state = execution.states().particles[place];
  const NodePlace at = execution.nodes().place_of(node);
  const bool enabled = execution.get<SFBool>(node, ParticleEvents::enabled);
  if (enabled && !state.running) state.running = std::make_shared<RunningParticles>();
  ParticleSettings settings;
  if (enabled) {
    settings = state.running->nodes.read(*at.scene, at.node, [&](std::size_t elements) {
      constexpr std::size_t kBytes = 128;
      return execution.budget().spend(elements) && execution.budget().afford(elements * kBytes);
    });
    // An old and a new particle may exist at the same time.
    constexpr std::size_t kBytes = 192, kWork = 16;
    if (!execution.nodes().afford_most(node, settings.most * kBytes) ||
        !execution.budget().spend(settings.most * kWork))
      settings.most = 0;
  }
  const bool active = enabled && settings.emitter.kind != ParticleEmitter::Kind::none;
  if (active != state.active) {
    // isActive was sent with this timestamp already.
    if (execution.has_sent(node, ParticleEvents::is_active)) return execution.timers().call_at(node, execution.now());
    state.active = active;
    execution.send(node, ParticleEvents::is_active, SFBool{active});
    if (active) {
      start_particles(execution, node, *state.running, settings);
    } else {
      at.scene->particles().set(at.node, nullptr);
      if (state.running) state.running->simulation = nullptr;
    }
    mark_particles(execution, node);
  }
  ParticleSimulation* const simulation = active ? state.running->simulation.get() : nullptr;
  if (simulation) {
    const bool was_busy = simulation->is_busy();
    simulation->pass_to(execution.now());
    if (settings != simulation->settings()) simulation->change(settings);
    if (was_busy || simulation->is_busy()) mark_particles(execution, node);
  }
  execution.timers().run(node, simulation && simulation->is_busy());
  // A system without particles looks now and then: an event may turn its emitter on, or a PROTO may give it an emitter.
  constexpr double kSeconds = 0.05;
  const bool waits = enabled && (simulation || execution.get<SFNode>(node, ParticleEvents::emitter));
  if (waits && !(simulation && simulation->is_busy())) execution.timers().call_at(node, execution.now() + kSeconds);
}

bool particle_event(Execution& execution, EventNode node, int, const FieldValue&) {
  execution.timers().look_again(node);
  return true;
}

}  // namespace

const Behaviour kParticleSystemBehaviour = {
    .events = {"enabled", "isActive", "emitter", "createParticles", "maxParticles", "particleLifetime",
               "lifetimeVariation", "particleSize", "geometry"},
    .initialize = begin_particles,
    .on_event = particle_event,
    .on_time = run_particles,
    .on_remove = end_particles,
};

}  // namespace gs::vrml
