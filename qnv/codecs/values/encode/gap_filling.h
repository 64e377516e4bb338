#pragma once

#include "qnv/codecs/values/encode/sample_batch.h"
#include "qnv/codecs/values/lifting.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gs::qnv::values {

/// Samples for missing voxels: means of their neighbours, from near to far. Keeps one number for 512 voxels.
class GapFilling {
 public:
  explicit GapFilling(Extent extent) : extent_(extent) {}

  /// Takes kBatchSlices slices, in order.
  void measure(const SampleBatch& batch);
  /// Completes the means of large boxes, after each rank has measured its slabs. Collective.
  void finish(Ranks& ranks);
  /// Replaces the samples of missing voxels of kBatchSlices slices.
  void fill(SampleBatch& batch) const;

 private:
  /// Means of boxes; NaN for boxes without values.
  struct Means {
    Extent n{};
    std::vector<float> means;
  };
  using BatchMeans = std::array<Means, 3>;  // of boxes of 2, 4 and 8 voxels per axis
  [[nodiscard]] BatchMeans means_of(const SampleBatch& batch) const;

  Extent extent_;
  std::vector<Means> levels_;  // of boxes of 8, 16, ... voxels per axis
};

}  // namespace gs::qnv::values
