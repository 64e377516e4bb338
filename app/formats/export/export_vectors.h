#pragma once

#include "qnv/base/geometry.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <vector>

namespace gs::app {

/// Vector with the attributes that export formats need.
struct ExportVector {
  glm::vec3 position{0};
  glm::vec3 normal{0, 0, 1};  // unit length, outwards
  float area = 0;             // positive
  qnv::Rgb8 color;
  float opacity = 1;  // 0..1
};

/// Sequence of vectors for export.
class ExportVectors {
 public:
  /// The viewed geometry must outlive this object.
  explicit ExportVectors(const qnv::VectorView& vectors);

  [[nodiscard]] std::size_t size() const { return vectors_.size(); }
  [[nodiscard]] ExportVector operator[](std::size_t i) const;
  /// Returns true if vectors become balls instead of flat splats. That is the case for volumes.
  [[nodiscard]] bool balls() const { return vectors_.kind == qnv::Kind::volume; }

 private:
  void shade_volume(std::size_t i, ExportVector& item) const;

  const qnv::VectorView vectors_;
  float ball_area_ = 1, most_weight_ = 1;
};

/// Returns the visible vectors. A visible vector is finite, has an area and an opacity of at least kMinOpacity.
[[nodiscard]] std::vector<ExportVector> visible_vectors(const ExportVectors& exported);

/// Gaussian splat. `scale` has its standard deviations along the axes of `rotation`.
struct ExportSplat {
  glm::vec3 position{0}, normal{0}, scale{0}, dc{0};
  glm::vec4 rotation{0, 0, 0, 1};  // unit quaternion x, y, z, w with w >= 0; turns +Z to the normal
  float opacity = 1;
};

/// Splats for export.
struct ExportSplats {
  std::vector<ExportSplat> splats;
  int degree = 0;                    // of the spherical harmonics
  std::vector<glm::vec3> harmonics;  // of degrees 1 to `degree`: qnv::harmonic_count(degree) per splat
  bool antialiased = false;          // as qnv::Gaussians::antialiased
};

/// Converts a geometry to splats. Multiplies the axes by `axes`, which must be a rotation. Gaussians stay as they are,
/// except that log odds need opacities of at most kMostOpacity. Of other geometries, the visible, finite vectors become
/// splats; those of a surface are kSplatThickness times as thick as wide. splats.h relates area and Gaussian.
[[nodiscard]] ExportSplats splats_of(const qnv::Geometry& geometry, const glm::vec3& axes);

inline constexpr float kSplatThickness = 0.01f;
/// Opacity of surface splats. Formats that store log odds cannot represent 1.
inline constexpr float kSurfaceOpacity = 0.99f;
/// Maximum opacity of a Gaussian. Its log odds are 16.
inline constexpr float kMostOpacity = 1 - 1.2e-7f;
/// Minimum standard deviation of a splat in formats that store its logarithm.
inline constexpr float kLeastScale = 1e-20f;

}  // namespace gs::app
