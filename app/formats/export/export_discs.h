#pragma once

#include "qnv/base/cloud.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <vector>

namespace gs::app {

/// A vector of a cloud as other formats want it.
struct ExportDisc {
  glm::vec3 position{0};
  glm::vec3 normal{0, 0, 1};  // unit, outwards
  float area = 0;             // > 0
  qnv::Rgb8 color;
  float opacity = 1;  // 0..1
};

/// The vectors of a cloud, one after the other.
class ExportDiscs {
 public:
  /// `cloud` must outlive this.
  explicit ExportDiscs(const qnv::Cloud& cloud);

  [[nodiscard]] std::size_t size() const { return cloud_.size(); }
  [[nodiscard]] ExportDisc operator[](std::size_t i) const;
  /// True for volumes: as thick as wide.
  [[nodiscard]] bool balls() const { return cloud_.description.kind == qnv::Kind::volume; }

 private:
  void shade_volume(std::size_t i, ExportDisc& disc) const;

  const qnv::Cloud& cloud_;
  float ball_area_ = 1, most_weight_ = 1;
};

/// Those that can be seen: finite, with an area, and not fainter than kLeastOpacity.
[[nodiscard]] std::vector<ExportDisc> visible_discs(const ExportDiscs& discs);

/// A splat: Gaussian with the standard deviations `scale` along the axes of `rotation`.
struct ExportSplat {
  glm::vec3 position{0}, normal{0}, scale{0}, dc{0};
  glm::vec4 rotation{0, 0, 0, 1};  // unit quaternion x, y, z, w, w >= 0; turns +Z into the normal
  float opacity = 1;
};

/// The vectors that can be seen and have finite numbers, as splats (splats.h says how discs and splats relate),
/// with their axes multiplied by `axes`, which must be a rotation. Discs are kDiscThickness as thick as wide.
[[nodiscard]] std::vector<ExportSplat> splats_of(const qnv::Cloud& cloud, const glm::vec3& axes);

inline constexpr float kDiscThickness = 0.01f;
/// Of the splats of surfaces: programs that store the logarithm of the odds cannot say 1.
inline constexpr float kSurfaceOpacity = 0.99f;

}  // namespace gs::app
