#include "vrml/inventor/output/transforms.h"

#include "vrml/scene/values/transformation.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gs::vrml::inventor {
namespace {

const SFVec3f kNoTranslation{0, 0, 0}, kNoScale{1, 1, 1};

bool is_finite(const glm::dmat4& matrix) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(matrix[column][row])) return false;
  return true;
}

bool is_translation(const TransformFields& fields) { return fields.rotation.angle == 0 && fields.scale == kNoScale; }

// Rotates the coordinate axes p and q so that the element (p, q) of the symmetric matrix vanishes (Jacobi).
void rotate_axes(glm::dmat3& symmetric, glm::dmat3& axes, int p, int q) {
  if (std::abs(symmetric[p][q]) < 1e-15) return;
  const double angle = 0.5 * std::atan2(2 * symmetric[p][q], symmetric[q][q] - symmetric[p][p]);
  glm::dmat3 turn(1);
  turn[p][p] = turn[q][q] = std::cos(angle);
  turn[p][q] = -std::sin(angle);
  turn[q][p] = std::sin(angle);
  symmetric = glm::transpose(turn) * symmetric * turn;
  axes = axes * turn;
}

// Returns the orthogonal factor of the polar decomposition by the iteration of Higham. The matrix must not be singular.
glm::dmat3 orthogonal_factor(glm::dmat3 matrix) {
  for (int i = 0; i < 60; ++i) {
    const glm::dmat3 next = 0.5 * (matrix + glm::transpose(glm::inverse(matrix)));
    double change = 0;
    for (int column = 0; column < 3; ++column) change += glm::length(next[column] - matrix[column]);
    matrix = next;
    if (change < 1e-14) break;
  }
  return matrix;
}

}  // namespace

glm::dmat4 TransformFields::matrix() const {
  return transform_matrix(translation, center, rotation, scale, scale_orientation);
}

SFRotation rotation_of(const glm::dmat3& m) {
  const double cosine = std::clamp((m[0][0] + m[1][1] + m[2][2] - 1) / 2, -1.0, 1.0);
  glm::dvec3 axis(m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]);
  const double angle = std::acos(cosine);
  if (glm::length(axis) < 1e-6) {
    if (cosine > 0) return {};
    // Half a turn: the axis is the largest column of m + 1.
    const glm::dmat3 sum = m + glm::dmat3(1);
    axis = sum[0];
    for (int column = 1; column < 3; ++column)
      if (glm::length(sum[column]) > glm::length(axis)) axis = sum[column];
  }
  axis = glm::normalize(axis);
  return {static_cast<float>(axis.x), static_cast<float>(axis.y), static_cast<float>(axis.z),
          static_cast<float>(angle)};
}

TransformFields decompose(const glm::dmat4& matrix, bool& inexact) {
  TransformFields fields;
  if (!is_finite(matrix)) {
    inexact = true;
    return fields;
  }
  const bool projective = matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] == 0;
  const double w = matrix[3][3] == 0 ? 1 : matrix[3][3];
  inexact |= projective;
  fields.translation = SFVec3f(matrix[3] / w);
  const glm::dmat3 linear = glm::dmat3(matrix) / w;
  const double size = std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
  const double volume = size > 0 ? glm::determinant(linear / size) : 0;
  if (std::abs(volume) < 1e-12) {
    // A flat matrix: exact only if it scales along the axes.
    const glm::dvec3 diagonal(linear[0][0], linear[1][1], linear[2][2]);
    fields.scale = SFVec3f(diagonal);
    glm::dmat3 rest = linear;
    for (int i = 0; i < 3; ++i) rest[i][i] = 0;
    inexact |= rest != glm::dmat3(0);
    return fields;
  }
  glm::dmat3 turn = orthogonal_factor(linear / size);
  glm::dmat3 stretch = glm::transpose(turn) * linear;
  if (volume < 0) {
    turn = -turn;
    stretch = -stretch;
  }
  fields.rotation = rotation_of(turn);
  glm::dmat3 symmetric = 0.5 * (stretch + glm::transpose(stretch)) / size, axes(1);
  for (int sweep = 0; sweep < 12; ++sweep) {
    rotate_axes(symmetric, axes, 0, 1);
    rotate_axes(symmetric, axes, 0, 2);
    rotate_axes(symmetric, axes, 1, 2);
  }
  fields.scale = SFVec3f(glm::dvec3(symmetric[0][0], symmetric[1][1], symmetric[2][2]) * size);
  const auto nearly = [](float a, float b) { return std::abs(a - b) <= 1e-6F * std::abs(a); };
  if (nearly(fields.scale.x, fields.scale.y) && nearly(fields.scale.x, fields.scale.z)) {
    fields.scale = SFVec3f(nearly(std::abs(fields.scale.x), 1) ? std::copysign(1.0F, fields.scale.x) : fields.scale.x);
    return fields;
  }
  if (glm::determinant(axes) < 0) axes[2] = -axes[2];
  fields.scale_orientation = rotation_of(axes);
  return fields;
}

glm::dmat4 product(std::span<const Operation> operations) {
  glm::dmat4 matrix(1);
  for (const Operation& operation : operations) matrix = matrix * operation.parent_from_local();
  return matrix;
}

TransformFields merge(std::span<const Operation> operations, bool& inexact) {
  TransformFields fields;
  bool exact = true;
  for (const Operation& operation : operations) {
    const TransformFields& next = operation.fields;
    if (operation.matrix) {
      exact = false;
    } else if (is_translation(fields)) {
      // Keeps the fields of a Transform after translations.
      const SFVec3f before = fields.translation;
      fields = next;
      fields.translation += before;
    } else if (is_translation(next)) {
      fields.translation += SFVec3f(glm::dmat3(fields.matrix()) * glm::dvec3(next.translation));
    } else if (fields.scale == kNoScale && fields.center == kNoTranslation && next.rotation.angle == 0 &&
               next.translation == kNoTranslation && next.center == kNoTranslation) {
      fields.scale = next.scale;
      fields.scale_orientation = next.scale_orientation;
    } else {
      exact = false;
    }
    if (!exact) break;
  }
  return exact ? fields : decompose(product(operations), inexact);
}

}  // namespace gs::vrml::inventor
