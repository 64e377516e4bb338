#pragma once

#include "qnv/codecs/values/labels/cube_order.h"
#include "qnv/codecs/values/labels/encode/label_pyramid.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Run in a store, with its use.
struct StoredLabelRun {
  std::uint64_t first = 0;     // code
  std::uint64_t offset = 0;    // of the payload
  std::int64_t corrected = 0;  // voxels that get their label, less those that lose it
  Extent low{}, high{};        // box in the voxels of the volume, `high` is excluded
  std::uint32_t count = 0;     // of codes
  std::uint16_t bytes = 0;     // of the payload
  std::uint16_t step = 0;      // of a time series
  std::uint8_t level = 0;
};

/// Counts the voxels that each run corrects, less those that are right with the coarser level only. `runs`
/// has the runs of each level, in the order of their codes. Adds the counts of whole levels to `sums`, including cubes
/// without a run. Ranks count parts of the volume. Returns false if this rank was cancelled. Collective.
bool count_corrected(const LabelPyramid::Levels& levels, std::span<const CubeOrder> orders,
                     std::span<std::vector<StoredLabelRun>> runs, std::span<std::int64_t> sums, Ranks& ranks,
                     unsigned threads, Progress* progress);

}  // namespace gs::qnv::values
