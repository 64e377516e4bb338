#pragma once

#include "base/parallel.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/encode/sample_batch.h"
#include "qnv/codecs/values/encode/stored_clusters.h"
#include "qnv/container/value_grid.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>

namespace gs::qnv::values {

/// Clusters in a store, in the order of the stream.
struct StoredOrder {
  const SpillStore& store;
  std::span<const StoredCluster> clusters;
  std::uint64_t blocks = 0;  // of the volume
};

/// Measures the errors of prefixes of a stream, from short ones to long ones. Decodes them slice by slice. Missing
/// voxels do not count.
class ErrorMeter {
 public:
  ErrorMeter(const ReadSamples& read, Extent extent, StoredOrder order, unsigned threads, Progress* progress);

  /// Decodes the first clusters, not fewer than in the calls before. If `corrections` is given, it gets the correction
  /// steps that keep `most_error`, and the result is the error after them. Returns an error if the samples or the
  /// clusters cannot be read, or if cancelled.
  [[nodiscard]] std::variant<ValueError, EncodeError> measure(std::size_t clusters, std::uint32_t most_error,
                                                              RemainderEncoder* corrections);

 private:
  const ReadSamples& read_;
  Extent extent_;
  const SpillStore& store_;
  StoredBlocks blocks_;
  unsigned threads_;
  Progress* progress_;
};

}  // namespace gs::qnv::values
