#pragma once

#include "base/parallel.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/container/value_grid.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Limits at which a stream ends: an error or a size.
struct ValuesLimit {
  std::uint32_t most_error = 0;  // maximum for every sample; 0 means lossless. Without effect if `max_bytes` is given
  std::size_t max_bytes = 0;     // of all chunks with their directory entries; 0 means unlimited
};

/// Clusters of a volume, the most useful per byte first.
struct EncodedValues {
  std::vector<Cluster> clusters;
  std::vector<double> gains;  // reduction of the squared error of the volume by each cluster, in steps
  /// Measured errors of samples, in steps: after about 4, 16, 64, ... kB, and at the end.
  std::vector<ValueError> errors;
  /// Signed number of correction steps per sample, as two's complement. Empty if no sample needs one.
  std::vector<std::uint32_t> corrections;
};

/// Returns the size of a correction step for a permitted error.
[[nodiscard]] constexpr std::uint32_t correction_step(std::uint32_t most_error) { return 2 * most_error + 1; }

/// Encodes a volume. Returns nullopt if `samples` does not match `extent`, or if cancelled. The bytes do not depend on
/// the number of threads. Blocks. Any thread.
[[nodiscard]] std::optional<EncodedValues> encode_values(std::span<const std::int32_t> samples, Extent extent,
                                                         const ValuesLimit& limit, unsigned threads = 0,
                                                         Progress* progress = nullptr);

}  // namespace gs::qnv::values
