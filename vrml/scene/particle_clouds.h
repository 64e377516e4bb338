#pragma once

#include "vrml/scene/node.h"

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <utility>

namespace gs::vrml {

class ParticleSimulation;

/// Particles of the active ParticleSystems of a scene. One thread.
class ParticleClouds {
 public:
  /// Sets the particles of a ParticleSystem. Null removes them.
  void set(NodeId system, std::shared_ptr<ParticleSimulation> particles) {
    if (particles)
      clouds_[system.index] = std::move(particles);
    else
      clouds_.erase(system.index);
  }
  /// Returns the particles of a ParticleSystem; null if it is not active.
  [[nodiscard]] ParticleSimulation* of(NodeId system) const {
    const auto found = clouds_.find(system.index);
    return found == clouds_.end() ? nullptr : found->second.get();
  }

 private:
  std::unordered_map<std::uint32_t, std::shared_ptr<ParticleSimulation>> clouds_;  // by index of the node
};

}  // namespace gs::vrml
