#pragma once

#include "qnv/base/description.h"
#include "qnv/base/geometry.h"
#include "qnv/codecs/values/labels/decode/label_levels.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace gs::qnv::values {

/// Returns the labels of a level as values. `in_order` is the number of chunks from the start of the stream, or nullopt
/// if one of them was lost or refused. Voxels without data get background_label(). The centres of coarse voxels are
/// those of the voxels that they stand for.
[[nodiscard]] std::shared_ptr<VolumeValues> label_values(const ValueGrid& grid, const Description& about,
                                                         const LabelLevels& levels, int level,
                                                         std::optional<std::uint32_t> in_order);

/// Returns the finest level that is decoded as a whole for at most `most_vectors` vectors.
[[nodiscard]] int finest_label_level(const ValueGrid& grid, std::size_t most_vectors);
/// Returns the maximum number of vectors at a level.
[[nodiscard]] std::size_t most_label_vectors(const ValueGrid& grid, int level, std::size_t most_vectors);
/// Returns the vectors of the surfaces of labels, with these values and the properties `base`.
[[nodiscard]] Volume label_surface(std::shared_ptr<const VolumeValues> values, GeometryBase base,
                                   std::size_t most_vectors);

// Parts of label_values().

/// Returns values without their source's function. They have 4 bytes per voxel.
[[nodiscard]] std::shared_ptr<VolumeValues> described_labels(const ValueGrid& grid, const Description& about,
                                                             int level);
/// Sets the share of wrong labels. `whole` means that all labels of the volume were received.
void note_label_errors(const ValueGrid& grid, bool whole, std::optional<std::uint32_t> in_order, VolumeValues& values);
/// Returns the label of voxels without data: that of the number 0, or the first one.
[[nodiscard]] std::uint32_t background_label(const LabelPalette& palette, VoxelType stored);
/// Replaces labels by the stored numbers, of 4 bytes each.
void label_numbers(std::span<std::uint32_t> labels, const LabelPalette& palette, VoxelType stored);

}  // namespace gs::qnv::values
