#pragma once

#include "app/formats/common/mesh_asset.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Returns two unit vectors perpendicular to a unit vector and to each other.
[[nodiscard]] std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& along);

/// Builder of round faces with a value at each position. Memory is charged to the MeshBuilder.
class FlowFaces {
 public:
  explicit FlowFaces(MeshBuilder& builder)
      : builder_(builder), positions_(builder), normals_(builder), index_(builder) {}

  /// Adds a ring of positions around `center`. Returns the index of its first position.
  std::int32_t ring(const glm::dvec3& center, const std::pair<glm::dvec3, glm::dvec3>& sides, double radius,
                    const glm::dvec3& lean, float value, std::uint32_t count);
  /// Joins two rings of `count` positions by faces.
  void join(std::int32_t a, std::int32_t b, std::uint32_t count);
  /// Adds an arrow that begins at `tail`.
  void add_arrow(const glm::dvec3& tail, const glm::dvec3& vector, float value);
  /// Adds the faces to the mesh, with a colour key that has the name `title`. Warns if there are no faces.
  void build(const std::string& title);

 private:
  MeshBuilder& builder_;
  Appender<glm::vec3> positions_, normals_;
  Appender<std::int32_t> index_;
  std::vector<float> values_;
};

/// Adds arrows for vectors at points, evenly thinned to at most 2,000. Their lengths are proportional to the vectors,
/// up to a maximum. Ignores vectors that are missing (NaN) or much shorter than the others.
void add_point_arrows(std::span<const glm::vec3> points, std::span<const glm::vec3> vectors, FlowFaces& faces);

}  // namespace gs::app
