#pragma once

#include "vrml/mesh/mesh.h"
#include "vrml/scene/scene_graph.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>

namespace gs::vrml {

/// Geometry of each particle: field geometryType of a ParticleSystem (X3D 40.4.5).
enum class ParticleShape : std::uint8_t { quad, line, point, sprite, geometry };
[[nodiscard]] ParticleShape particle_shape(const SceneGraph& scene, NodeId system);

/// Data of a picture for the mesh of a particle system, in the space of the ParticleSystem.
struct ParticleView {
  glm::dvec3 viewer{0, 0, 10}, up{0, 1, 0};  // for sprites, which face the viewer
  bool texture_coordinates = false;
  std::shared_ptr<const Mesh> geometry;  // mesh of the field `geometry`; null if there is none
  glm::vec3 scale{1};                    // scale of `geometry`
};

/// Maximum indices and vertices of the mesh. The newest particles that do not fit are left out.
inline constexpr std::size_t kMaxParticleIndices = std::size_t{3} << 20;

/// Returns the present particles of a ParticleSystem as one mesh. Returns an empty mesh if the system is not active.
[[nodiscard]] Mesh particle_mesh(const SceneGraph& scene, NodeId system, const ParticleView& view);

/// Returns a box for the particles of a system: the fields bboxCenter and bboxSize if they are set, or else an
/// estimate.
[[nodiscard]] Box particle_region(const SceneGraph& scene, NodeId system);

}  // namespace gs::vrml
