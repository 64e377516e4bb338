#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/values/labels/encode/stored_labels.h"
#include "qnv/container/label_palette.h"
#include "qnv/sampling/volume/volume.h"

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv::values {

/// Label volumes in a store, with their coarser levels: the steps of a time series, or one volume.
struct LabelPyramid {
  using Levels = std::vector<StoredLabels>;  // 0 is the volume

  std::shared_ptr<const LabelPalette> palette;  // of all steps
  VoxelType stored = VoxelType::u8;             // of the codes; f64 becomes i32 or u32
  std::vector<std::uint64_t> counts;            // of voxels of all steps, by label
  std::vector<Levels> steps;
};

/// Reads label volumes slice by slice. Each rank reads some layers of the volume and of each coarser level; all get the
/// result. A coarse label is the most frequent of eight. Among equally frequent ones,
/// the rarest in all volumes wins, so that thin sheets remain. All steps must have the layout of the first
/// one. Returns an error if a source or the store fails, if a number has a fraction, on too many voxels or labels,
/// or if cancelled. Needs memory for about three slices of 4 bytes per voxel, and 24 bytes for each label. `store` must
/// outlive the result. Safe for untrusted values.
[[nodiscard]] std::variant<LabelPyramid, EncodeError> read_labels(std::span<const VolumeSource> steps,
                                                                  SharedStore& store, Ranks& ranks, unsigned threads,
                                                                  Progress* progress);

}  // namespace gs::qnv::values
