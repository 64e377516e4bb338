#pragma once

#include "app/formats/common/color_key.h"
#include "qnv/base/cloud.h"
#include "render/rays/mesh_bvh.h"
#include "vrml/mesh/mesh.h"

#include <glm/vec3.hpp>

#include <optional>

namespace gs::app {

/// What the vectors of a volume say of a place, where its voxels are not at hand: of a stream.
struct VectorValue {
  double value = 0;     // of the nearest vector
  double step = 0;      // the values that vectors can have differ by so much
  double gradient = 0;  // its magnitude: value per unit of length
};

/// Of the vector that is nearest to `place`, in the volume's space; nothing where there is none, or none that has a
/// value. Looks at all of them: some milliseconds a million.
[[nodiscard]] std::optional<VectorValue> value_near(const qnv::Cloud& volume, const glm::dvec3& place);

/// What the colours of a surface say where it was hit: between its corners in proportion. Nothing where it has no
/// colours of its own there.
[[nodiscard]] std::optional<double> value_on(const ColorKey& key, const vrml::Mesh& mesh,
                                             const render::TriangleHit& hit);

}  // namespace gs::app
