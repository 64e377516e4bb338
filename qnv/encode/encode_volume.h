#pragma once

#include "qnv/base/cloud.h"
#include "qnv/volume/volume.h"
#include "qnv/volume/volume_slices.h"

#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Which of a volume's gradient vectors are kept: the longest, as many as both bounds allow.
struct GradientOptions {
  /// Of all voxels of the volume, missing ones and those without a gradient included: at most
  /// round(fraction * voxels) vectors. 0..1; the paper's figure 2 ends at 0.091.
  double fraction = 0.09;
  /// At most this many. More than 2^31 cannot be asked for.
  std::uint64_t vectors = std::uint64_t{1} << 31;
  unsigned threads = 0;  // 0: one a core
};

/// The gradient vectors of a volume (paper, section 2.1), longest first, equally long ones in the order of
/// their voxels; the same for every number of threads.
///
/// A vector stands at its voxel's centre and has the direction of the gradient (towards higher values),
/// the gradient's length as its weight (value per world unit) and the voxel's value as its class, 0..255 from the
/// least to the largest value that is there. Gradients are central differences in world space, one-sided next to
/// borders and missing voxels. Missing voxels and zero gradients have no vector.
///
/// The description has the volume's metadata, the box of the voxels' centres, the sum of all lengths (of
/// vectors that were left out too), the shortest axis and default_transfer().
///
/// Reads the volume two or three times, slice by slice: needs memory for a few slices and for the result.
/// Errors: an unsound layout or options, a source that cannot be read, no value at all, cancelled. Progress counts
/// slices. Any thread; safe for untrusted values.
[[nodiscard]] std::variant<Cloud, VolumeError> gradient_vectors(const VolumeSource& source,
                                                                const GradientOptions& options,
                                                                Progress* progress = nullptr);

/// A soft start for a transfer function over values from `least` to `most`: from transparent through warm
/// colours to white, nearly opaque. Where zero lies in the lower half of the range, it and what is below
/// are transparent: noise about an empty background.
[[nodiscard]] std::vector<TransferPoint> default_transfer(float least, float most);

/// The box of the centres of all voxels of a sound layout, from its base.
[[nodiscard]] Box voxel_box(const VolumeLayout& layout);

/// The centre of voxel (x, y, z), world units from the layout's base; fractions are between voxels.
[[nodiscard]] inline glm::vec3 voxel_position(const VolumeLayout& layout, double x, double y, double z) {
  const auto along = [&](int i) {
    return static_cast<float>(((layout.origin[i] + layout.axes[0][i] * x) + layout.axes[1][i] * y) +
                              layout.axes[2][i] * z);
  };
  return {along(0), along(1), along(2)};
}

}  // namespace gs::qnv
