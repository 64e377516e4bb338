#pragma once

#include "vrml/scene/values/field_value.h"

#include <glm/mat4x4.hpp>

#include <optional>
#include <span>

namespace gs::vrml::inventor {

/// Fields of a VRML97 Transform.
struct TransformFields {
  SFVec3f translation{0, 0, 0}, center{0, 0, 0}, scale{1, 1, 1};
  SFRotation rotation, scale_orientation;

  [[nodiscard]] glm::dmat4 matrix() const;
};

/// Transformation that one node adds to the traversal state.
struct Operation {
  TransformFields fields;
  std::optional<glm::dmat4> matrix;  // transformation that is not given as fields

  [[nodiscard]] glm::dmat4 parent_from_local() const { return matrix ? *matrix : fields.matrix(); }
};

/// Returns the fields of one Transform for operations that are applied in sequence, the last one first to the points.
/// Sets `inexact` if the matrix is singular or projective.
[[nodiscard]] TransformFields merge(std::span<const Operation> operations, bool& inexact);
/// Returns the fields that give this matrix.
[[nodiscard]] TransformFields decompose(const glm::dmat4& matrix, bool& inexact);
/// Returns the product of the matrices of the operations.
[[nodiscard]] glm::dmat4 product(std::span<const Operation> operations);
/// Returns the rotation of an orthogonal matrix with determinant 1.
[[nodiscard]] SFRotation rotation_of(const glm::dmat3& matrix);

}  // namespace gs::vrml::inventor
