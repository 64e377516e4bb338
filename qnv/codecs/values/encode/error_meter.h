#pragma once

#include "base/parallel.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/encode/sample_batch.h"
#include "qnv/codecs/values/slices/slice_transform.h"
#include "qnv/container/value_grid.h"

#include <cstddef>
#include <cstdint>
#include <variant>

namespace gs::qnv::values {

/// Measures the errors of decoded volumes, slice by slice. Missing voxels do not count.
class ErrorMeter {
 public:
  ErrorMeter(const ReadSamples& read, Extent extent, unsigned threads, Progress* progress)
      : read_(read), extent_(extent), threads_(threads), progress_(progress) {}

  /// Measures the error of the samples restored from the coefficients of `write`. If `corrections` is given, adds the
  /// correction steps that keep `most_error`, and measures the error after them. Returns an error if the samples cannot
  /// be read, or if cancelled. The result has no number of chunks.
  [[nodiscard]] std::variant<ValueError, EncodeError> measure(const SliceRestorer::WriteBlock& write,
                                                              std::uint32_t most_error, RemainderEncoder* corrections);

 private:
  const ReadSamples& read_;
  Extent extent_;
  unsigned threads_;
  Progress* progress_;
};

}  // namespace gs::qnv::values
