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

/// Statistics of all triangles of a surface. Ignores triangles that are not finite.
struct SurfaceSurvey {
  Box box;
  double area = 0, volume = 0;
  glm::dvec3 facing{0};  // sum of all triangle normals, weighted by area
  std::size_t triangles = 0;
  bool colored = false;  // the triangles have more than one colour
  Rgb8 color;            // colour of the first corner
  glm::dvec3 colors{0};  // sum of all triangle colours, weighted by area

  void add(std::span<const Triangle> triangles);
  /// Adds the statistics of later triangles.
  void add(const SurfaceSurvey& later);
  /// Returns the only colour, or the mean colour, which is drawn until the colours are received.
  [[nodiscard]] Rgb8 mean_color() const;
  /// Reports whether the surface is closed: its area vectors cancel, and it encloses a volume. The inside of a closed
  /// surface is never visible.
  [[nodiscard]] bool closed() const;
  /// Reports whether the surface has triangles that can be encoded.
  [[nodiscard]] bool sound() const;
};

/// Returns the description of the vectors that can be sent. The total counts only these, because receivers distribute
/// it over the received vectors. `metadata` precedes the geometry's own.
[[nodiscard]] Description describe_vectors(const VectorView& vectors,
                                           const std::vector<std::pair<std::string, std::string>>& metadata);

}  // namespace gs::qnv
