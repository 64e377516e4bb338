#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/values/labels/label_runs.h"
#include "qnv/container/label_palette.h"
#include "qnv/sampling/volume/volume.h"

#include <cstdint>
#include <variant>
#include <vector>

namespace gs::qnv::values {

/// Label volume in memory, with its coarser levels.
struct LabelPyramid {
  LabelPalette palette;
  VoxelType stored = VoxelType::u8;   // of the codes; f64 becomes i32 or u32
  std::vector<std::uint64_t> counts;  // of voxels, by label
  std::vector<LabelGrid> levels;      // 0 is the volume
};

/// Reads a label volume. In coarser levels, a label is the most frequent one of eight; of equally frequent ones, the
/// rarest in the volume, so that thin sheets remain. Returns an error if the source fails, if numbers have a fraction,
/// for too many voxels or labels, or if cancelled. Needs 5 bytes of memory per voxel. Safe for untrusted values.
[[nodiscard]] std::variant<LabelPyramid, EncodeError> read_labels(const VolumeSource& source, unsigned threads,
                                                                  Progress* progress);

}  // namespace gs::qnv::values
