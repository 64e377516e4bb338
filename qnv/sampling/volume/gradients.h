#pragma once

#include "qnv/base/geometry.h"
#include "qnv/sampling/volume/volume.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Selection of a volume's gradient vectors: the longest, within both limits.
struct GradientOptions {
  /// Limits the vectors to round(fraction * voxels) of all voxels, including missing ones and those without a gradient.
  /// 0..1; figure 2 of the paper ends at 0.091.
  double fraction = 0.09;
  /// Limits the vectors to an absolute number; 2^31 is the maximum.
  std::uint64_t vectors = std::uint64_t{1} << 31;
  unsigned threads = 0;  // 0: one per core
};

/// Returns the gradient vectors of a volume (paper, section 2.1), longest first; vectors of equal length are in the
/// order of their voxels. The result does not depend on the number of threads. A vector's position is its voxel's
/// centre, its direction the gradient's (towards higher values), and its weight the gradient's length (value per world
/// unit). Its class is the voxel's value, 0..255 from the minimum to the maximum. Gradients are central differences in
/// world space, one-sided next to borders and missing voxels. Missing voxels and zero gradients have no vector. The
/// description has the volume's metadata, the box of the voxels' centres, the shortest axis and default_transfer(). Its
/// total is the sum of all lengths, including omitted vectors. Reads the volume two or three times, slice by slice.
/// Needs memory for a few slices and the result. Returns an error for an invalid layout or options, a source that
/// fails, a volume without values, or if cancelled. Progress counts slices. Safe from any thread and for untrusted
/// values.
[[nodiscard]] std::variant<Volume, VolumeError> gradient_vectors(const VolumeSource& source,
                                                                 const GradientOptions& options,
                                                                 Progress* progress = nullptr);

/// Returns an initial transfer function for values from `least` to `most`: from transparent through warm colours to
/// nearly opaque white. If zero lies in the lower half of the range, zero and everything below are transparent, which
/// hides noise around an empty background.
[[nodiscard]] std::vector<TransferPoint> default_transfer(float least, float most);

/// Returns the box of all voxel centres of a valid layout, relative to its base.
[[nodiscard]] Box voxel_box(const VolumeLayout& layout);

/// Returns the centre of voxel (x, y, z), world units relative to the layout's base. Fractions interpolate.
[[nodiscard]] inline glm::vec3 voxel_position(const VolumeLayout& layout, double x, double y, double z) {
  const auto along = [&](int i) {
    return static_cast<float>(((layout.origin[i] + layout.axes[0][i] * x) + layout.axes[1][i] * y) +
                              layout.axes[2][i] * z);
  };
  return {along(0), along(1), along(2)};
}

}  // namespace gs::qnv
