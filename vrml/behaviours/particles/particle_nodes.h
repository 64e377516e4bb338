#pragma once

#include "vrml/behaviours/particles/particle_settings.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>

namespace gs::vrml {

/// Reads the settings of a ParticleSystem from its nodes. Keeps the surfaces and lines of emitters and physics models
/// until their nodes change.
class ParticleNodes {
 public:
  /// Draws memory and work of a new surface; returns false if the surface must be omitted.
  using Afford = std::function<bool(std::size_t elements)>;

  [[nodiscard]] ParticleSettings read(const SceneGraph& scene, NodeId system, const Afford& afford);

 private:
  /// Object made from a geometry, with a digest of its fields.
  template <class Object>
  struct Kept {
    std::uint64_t digest = 0;
    std::shared_ptr<const Object> object;
  };
  [[nodiscard]] ParticleEmitter emitter(const SceneGraph& scene, NodeId node, const Afford& afford);
  [[nodiscard]] std::shared_ptr<const SurfaceTree> surface(const SceneGraph& scene, NodeId geometry,
                                                           const Afford& afford);
  [[nodiscard]] std::shared_ptr<const ParticleLines> lines(const SceneGraph& scene, NodeId emitter,
                                                           const Afford& afford);

  std::unordered_map<std::uint32_t, Kept<SurfaceTree>> surfaces_;  // by index of the node
  std::unordered_map<std::uint32_t, Kept<ParticleLines>> lines_;
};

}  // namespace gs::vrml
