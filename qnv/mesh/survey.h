#pragma once

#include "qnv/base/geometry.h"
#include "qnv/base/triangles.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {

/// Statistics over all triangles of a surface; skips triangles that are not finite.
struct SurfaceSurvey {
  Box box;
  double area = 0, volume = 0;
  glm::dvec3 facing{0};  // sum of all normals times their areas
  std::size_t triangles = 0;
  bool colored = false;  // has more than one colour
  Rgb8 color;            // of the first corner
  glm::dvec3 colors{0};  // sum of all colours times the triangles' areas

  void add(std::span<const Triangle> triangles);
  /// Returns the single colour, or the mean, which is shown until the colours are received.
  [[nodiscard]] Rgb8 mean_color() const;
  /// Reports whether the surface is closed: its area vectors cancel, and it encloses a volume. Its inside is then never
  /// visible.
  [[nodiscard]] bool closed() const;
  /// Reports whether there is something to encode.
  [[nodiscard]] bool sound() const;
};

/// Returns the description of the vectors that can be sent. The total counts only these, because receivers distribute
/// it over the received vectors. `metadata` precedes the geometry's own.
[[nodiscard]] Description describe_vectors(const VectorView& vectors,
                                           const std::vector<std::pair<std::string, std::string>>& metadata);

}  // namespace gs::qnv
