#pragma once

#include "app/formats/common/color_key.h"
#include "qnv/base/geometry.h"
#include "render/rays/mesh_bvh.h"
#include "vrml/mesh/mesh.h"

#include <glm/vec3.hpp>

#include <optional>

namespace gs::app {

/// Value of a volume at a point, read from a stream's vectors when no voxels are available.
struct VectorValue {
  double value = 0;     // value of the nearest vector
  double step = 0;      // smallest difference between two values of vectors
  double gradient = 0;  // gradient magnitude: value per unit of length
};

/// Returns the value of the vector nearest to `place`, in the volume's space. Returns nullopt if no vector has a value.
/// Scans all vectors: some milliseconds per million.
[[nodiscard]] std::optional<VectorValue> value_near(const qnv::Volume& volume, const glm::dvec3& place);

/// Returns the value that a surface's colours represent at a hit, interpolated between the corners. Returns nullopt if
/// the surface has no colours of its own there.
[[nodiscard]] std::optional<double> value_on(const ColorKey& key, const vrml::Mesh& mesh,
                                             const render::TriangleHit& hit);

}  // namespace gs::app
