#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/triangles.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {

/// What is known of a surface once all of its triangles have been seen. Those that are not finite do not count.
struct SurfaceSurvey {
  Box box;
  double area = 0, volume = 0;
  glm::dvec3 facing{0};  // sum of all triangles' normals times their areas
  std::size_t triangles = 0;
  bool colored = false;  // not all of one colour
  Rgb8 color;            // of the first corner
  glm::dvec3 colors{0};  // sum of all triangles' colours times their areas

  void add(std::span<const Triangle> triangles);
  /// That of a surface of one colour; else the mean, which stands for them until they come.
  [[nodiscard]] Rgb8 mean_color() const;
  /// The areas of a closed surface cancel, and it encloses something: then its inside is never seen.
  [[nodiscard]] bool closed() const;
  /// Whether there is something to encode.
  [[nodiscard]] bool sound() const;
};

/// What the header says of the vectors that can be sent: the stream's total is theirs, because a receiver shares out as
/// much over what arrives. `metadata` comes before what the cloud says of itself.
[[nodiscard]] Description describe_vectors(const Cloud& cloud,
                                           const std::vector<std::pair<std::string, std::string>>& metadata);

}  // namespace gs::qnv
