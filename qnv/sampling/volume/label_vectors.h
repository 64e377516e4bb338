#pragma once

#include "qnv/sampling/volume/gradients.h"

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Label of a volume.
struct VolumeLabel {
  double number = 0;        // stored number
  std::uint64_t count = 0;  // of voxels
};

/// Returns the label that is not drawn: 0 if the volume has it, else the most frequent one. Returns null without
/// labels.
[[nodiscard]] const VolumeLabel* background_of(std::span<const VolumeLabel> labels);
/// Returns the colour of a label. Labels that follow each other have different ones.
[[nodiscard]] Rgb8 label_color(double number);
/// Reports whether the labels have different classes, 0 to 255 over their range. The transfer function then has their
/// colours.
[[nodiscard]] bool has_label_classes(std::span<const double> numbers);
/// Returns the transfer function of labels, in ascending order: nearly opaque, in their colours.
[[nodiscard]] std::vector<TransferPoint> label_transfer(std::span<const double> numbers);

/// Returns vectors of the voxels at the surfaces of labels, like gradient_vectors() for other volumes. The direction of
/// a vector is the normal of the surface between its label and all others, smoothed over two voxels; its position is
/// moved to this surface. All weights are equal. The order is pseudo-random, so that the first vectors show the whole
/// surface. The background has no vectors.
[[nodiscard]] std::variant<Volume, VolumeError> label_vectors(const VolumeSource& source,
                                                              const GradientOptions& options,
                                                              Progress* progress = nullptr);

}  // namespace gs::qnv
