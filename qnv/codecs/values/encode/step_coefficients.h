#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/encode/stored_clusters.h"
#include "qnv/codecs/values/slices/slice_transform.h"

#include <cstdint>
#include <vector>

namespace gs::qnv::values {

/// Decoded coefficients of a step of a time series, to which the next step refers. Takes 4 bytes per voxel.
class StepCoefficients {
 public:
  explicit StepCoefficients(Extent extent);

  /// Returns the coefficients of a block.
  [[nodiscard]] BlockBands bands_of(const BlockPlace& place) { return bands_in_volume(place, values_, extent_); }
  /// Decodes the next step. The first step of a chain does not refer to the one before.
  void decode(const StoredBlocks& blocks, bool first, unsigned threads);
  /// Returns a function that writes the coefficients of blocks, for SliceRestorer.
  [[nodiscard]] SliceRestorer::WriteBlock writer();

 private:
  Extent extent_;
  BlockLayout layout_;
  std::vector<std::int32_t> values_;
};

}  // namespace gs::qnv::values
