#pragma once

#include "qnv/base/geometry.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Axis-aligned box, in source coordinates.
struct SplatBox {
  glm::dvec3 lower{0}, upper{0};
  friend bool operator==(const SplatBox&, const SplatBox&) = default;
};

/// Ball, in source coordinates.
struct SplatBall {
  glm::dvec3 center{0};
  double radius = 0;
  friend bool operator==(const SplatBall&, const SplatBall&) = default;
};

/// Region that selects splats by their centres.
struct SplatCrop {
  std::variant<SplatBox, SplatBall> shape;
  bool removes = false;  // removes the splats inside; otherwise keeps them
  friend bool operator==(const SplatCrop&, const SplatCrop&) = default;
};

/// Edit of Gaussian splats by the user. The crops and the limits select splats, in source coordinates. The remaining
/// splats are scaled and turned about the point 0 0 0, and then moved. The exposure changes their colours.
struct SplatEdit {
  /// Regions in any order. A splat remains if it is in no region that removes, and in at least one region that keeps.
  /// If no region keeps, all splats outside of the removing regions remain.
  std::vector<SplatCrop> crops;
  double least_opacity = 0;  // minimum opacity of a splat at its centre
  double most_size = 0;      // maximum standard deviation of a splat; 0 means unlimited
  double scale = 1;
  glm::dvec3 turn{0};   // degrees about the axes x, y and z, in this order
  glm::dvec3 move{0};   // units of the source
  double exposure = 0;  // stops; each one doubles the light

  static constexpr double kMostScale = 1e6, kMostExposure = 16;

  friend bool operator==(const SplatEdit&, const SplatEdit&) = default;
  /// Returns true if the edit changes nothing.
  [[nodiscard]] bool empty() const { return *this == SplatEdit{}; }
};

/// Returns the transformation of positions as a homogeneous matrix.
[[nodiscard]] glm::dmat4 matrix_of(const SplatEdit& edit);

/// Numbers of splats that an edit removed, each counted by its first reason.
struct SplatsRemoved {
  std::size_t before = 0;  // number of splats before the edit
  std::size_t cropped = 0, faint = 0, large = 0, far = 0;
  [[nodiscard]] std::size_t all() const { return cropped + faint + large + far; }
};

/// Applies an edit. Rotates the spherical harmonics with the splats. Updates origin, box and areas. Removes splats that
/// would leave the range of coordinates. Any thread.
SplatsRemoved edit_splats(qnv::Gaussians& splats, const SplatEdit& edit);

/// Returns one message for each reason that removed splats.
[[nodiscard]] std::vector<std::string> messages_of(const SplatsRemoved& removed);

/// Returns the options of `export` and `encode` that make this edit.
[[nodiscard]] std::vector<std::string> options_of(const SplatEdit& edit);

}  // namespace gs::app
