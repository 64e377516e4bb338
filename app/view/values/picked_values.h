#pragma once

#include "app/formats/common/color_key.h"
#include "app/view/values/volume_display.h"
#include "app/view/values/volume_grid.h"
#include "qnv/base/geometry.h"
#include "render/rays/mesh_bvh.h"
#include "vrml/mesh/mesh.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace gs::app {

/// Value of a volume at a point according to the stream's vectors. Used if the file has no voxels.
struct VectorValue {
  double value = 0;     // value of the nearest vector
  double step = 0;      // smallest difference between two values
  double gradient = 0;  // magnitude of the gradient: change of the value per unit of length
};

/// Returns the value of the vector that is nearest to `place`, which is in the volume's space. Returns nullopt if no
/// vector has a value. Searches all vectors: some milliseconds per million.
[[nodiscard]] std::optional<VectorValue> value_near(const qnv::Volume& volume, const glm::dvec3& place);

/// Returns the value that the colour of a surface stands for at a hit, interpolated between the corners of the
/// triangle. Returns nullopt if the surface has no colours there that stand for values.
[[nodiscard]] std::optional<double> value_on(const ColorKey& key, const vrml::Mesh& mesh,
                                             const render::TriangleHit& hit);

/// Value of a projection along a ray.
struct ProjectedValue {
  double value = 0;
  std::optional<glm::dvec3> voxel;  // with the minimum or maximum; nullopt for an average
};
/// Returns the value that a projection shows along the ray from `origin`, both in world space. Returns nullopt if the
/// ray misses the volume, or if all its values are missing.
[[nodiscard]] std::optional<ProjectedValue> projected_value(const VolumeGrid& grid, VolumeMode mode,
                                                            const glm::dmat4& volume_from_world,
                                                            const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace gs::app
