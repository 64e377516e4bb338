#pragma once

#include "base/box.h"
#include "base/finite.h"
#include "qnv/base/shine.h"
#include "qnv/base/triangles.h"
#include "vrml/mesh/mesh.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

/// Triangles of tessellated meshes, for all encoders. Needs no renderer.
namespace gs::app {

/// Convert 0..1 to 0..255, rounded to the nearest integer.
[[nodiscard]] std::uint8_t to_byte(float value);
[[nodiscard]] qnv::Rgb8 to_rgb8(const glm::vec3& color);

/// Corner of a triangle in world space, relative to an origin. The normal has unit length or is 0.
struct SurfaceCorner {
  glm::vec3 position, normal, color;
  glm::vec2 texture;
};
[[nodiscard]] inline qnv::Triangle triangle_of(const std::array<SurfaceCorner, 3>& corners) {
  qnv::Triangle triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.positions[i] = corners[i].position;
    triangle.normals[i] = corners[i].normal;
    triangle.colors[i] = to_rgb8(corners[i].color);
  }
  return triangle;
}

/// Reader of the triangles of a mesh at one instance. The mesh must outlive it.
class SurfaceCorners {
 public:
  /// `color` is the colour of vertices that have none.
  SurfaceCorners(const vrml::Mesh& mesh, const glm::dmat4& world_from_node, const glm::vec3& color,
                 const glm::dvec3& origin);

  [[nodiscard]] SurfaceCorner corner(std::uint32_t index) const {
    SurfaceCorner c{};
    c.position = glm::vec3(place_ * glm::dvec4(mesh_.positions[index], 1));
    if (has_normals_) {
      const glm::vec3 n = normal_matrix_ * mesh_.normals[index];
      const float length = std::sqrt(glm::dot(n, n));
      if (length > 0 && std::isfinite(length)) c.normal = n / length;
    }
    c.color = color_;
    if (has_colors_) {
      const vrml::Color& v = mesh_.colors[index];
      c.color = {v.r, v.g, v.b};
    }
    return c;
  }

  /// Calls `work` with the corners of each triangle until it returns false. `make(index)` returns a corner.
  template <class Make, class Work>
  bool each(const Make& make, const Work& work) const {
    for (std::size_t i = 0; i + 2 < mesh_.indices.size(); i += 3) {
      std::array<SurfaceCorner, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) corners[k] = make(mesh_.indices[i + k]);
      if (flipped_) std::swap(corners[1], corners[2]);
      if (!work(corners)) return false;
    }
    return true;
  }

 private:
  const vrml::Mesh& mesh_;
  glm::dmat4 place_;  // from node space to world space, relative to the origin
  glm::mat3 normal_matrix_{1.0f};
  glm::vec3 color_;
  bool flipped_ = false, has_normals_, has_colors_;
};

/// Buffer that passes triangles to a sink, in batches.
class TriangleBatches {
 public:
  explicit TriangleBatches(const qnv::TriangleSink& sink) : sink_(sink) {}
  /// Adds a triangle, unless a coordinate is not finite. Returns false if the sink stopped.
  [[nodiscard]] bool add_finite(const std::array<SurfaceCorner, 3>& corners) {
    for (const SurfaceCorner& corner : corners)
      if (!finite(corner.position)) return true;
    return add(triangle_of(corners));
  }
  [[nodiscard]] bool add(const qnv::Triangle& triangle) {
    batch_.push_back(triangle);
    return batch_.size() < kBatch || flush();
  }
  [[nodiscard]] bool flush() {
    const bool more = batch_.empty() || sink_(batch_);
    batch_.clear();
    return more;
  }

 private:
  static constexpr std::size_t kBatch = 4096;
  const qnv::TriangleSink& sink_;
  std::vector<qnv::Triangle> batch_;
};

/// Summary of the triangles of a surface.
struct SurfaceSummary {
  WideBox box;  // bounds of all corners in use
  std::size_t triangles = 0;  // number of triangles before subdivision
  bool two_sided = false;  // true if some mesh is also visible from behind
  bool textured = false;
  std::optional<qnv::Shine> shine;  // shine of all Shapes; nullopt if it differs between them

  void add(const vrml::Mesh& mesh, const glm::dmat4& world_from_node, const qnv::Shine& of_shape);

 private:
  bool any_ = false;
};

}  // namespace gs::app
