#pragma once

#include "qnv/base/geometry.h"
#include "qnv/sampling/volume/volume.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Selection of a volume's gradient vectors: takes the longest ones, within both limits.
struct GradientOptions {
  /// Limits the number of vectors to round(fraction * voxels), 0..1. Counts all voxels, even missing ones and those
  /// without a gradient. Figure 2 of the paper ends at 0.091.
  double fraction = 0.09;
  /// Maximum number of vectors; at most 2^31.
  std::uint64_t vectors = std::uint64_t{1} << 31;
  unsigned threads = 0;                            // 0 means one per core
  std::optional<std::pair<float, float>> range{};  // values of classes 0 and 255; nullopt means the range of the volume
};

/// Returns the gradient vectors of a volume (paper, section 2.1), longest first; vectors of equal length are in the
/// order of their voxels. Returns label_vectors() for labels. Vectors of colour volumes have colours, and opacities for
/// their brightness. The result does not depend on the number of threads.
/// The position of a vector is the centre of its voxel, its direction that of the gradient (towards higher values), and
/// its weight the length of the gradient (value per world unit). Its class is the value of the voxel, 0..255 from the
/// minimum to the maximum of the range. Gradients are central differences in world space; they are one-sided next to
/// borders and missing voxels. Missing voxels and zero gradients have no vector. The description has the volume's
/// metadata, the box of the voxels' centres, the shortest axis and default_transfer(). Its total is the sum of all
/// lengths, including omitted vectors. Reads the volume two or three times, slice by slice. Needs memory for a few
/// slices and the result. Returns an error for an invalid layout or invalid options, if the source fails, for a volume
/// without values, or if cancelled. Progress counts slices. Any thread. Safe for untrusted values.
[[nodiscard]] std::variant<Volume, VolumeError> gradient_vectors(const VolumeSource& source,
                                                                 const GradientOptions& options,
                                                                 Progress* progress = nullptr);

/// Returns an initial transfer function for values from `least` to `most`: from transparent through warm colours to
/// nearly opaque white. If zero is in the lower half of the range, values up to zero are transparent, which hides noise
/// around an empty background.
[[nodiscard]] std::vector<TransferPoint> default_transfer(float least, float most);

/// Returns the box of the centres of all voxels, relative to the layout's base. The layout must be valid.
[[nodiscard]] Box voxel_box(const VolumeLayout& layout);

/// Returns what the layout of a volume tells about its vectors: origin, box, spacing and metadata. The layout must be
/// valid.
[[nodiscard]] Description volume_description(const VolumeLayout& layout);

/// Returns the centre of voxel (x, y, z), in world units relative to the layout's base. For fractions, interpolates.
[[nodiscard]] inline glm::vec3 voxel_position(const VolumeLayout& layout, double x, double y, double z) {
  const auto along = [&](int i) {
    return static_cast<float>(((layout.origin[i] + layout.axes[0][i] * x) + layout.axes[1][i] * y) +
                              layout.axes[2][i] * z);
  };
  return {along(0), along(1), along(2)};
}

}  // namespace gs::qnv
