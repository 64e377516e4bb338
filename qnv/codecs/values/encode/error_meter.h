#pragma once

#include "base/parallel.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/encode/sample_batch.h"
#include "qnv/codecs/values/slices/slice_transform.h"
#include "qnv/container/value_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

namespace gs::qnv::values {

/// Exact sum of squares, as an integer of 128 bits. The order of the numbers does not change it.
struct SquareSum {
  std::uint64_t low = 0, high = 0;

  void add(std::uint64_t number) {
    low += number;
    high += low < number ? 1 : 0;
  }
  void add(const SquareSum& other) {
    add(other.low);
    high += other.high;
  }
  [[nodiscard]] double value() const { return std::ldexp(static_cast<double>(high), 64) + static_cast<double>(low); }
};

/// Maximum, sum of squares and number of errors.
struct ErrorSum {
  std::int64_t most = 0;
  SquareSum squares;
  std::uint64_t count = 0;

  void add(const ErrorSum& other) {
    most = std::max(most, other.most);
    squares.add(other.squares);
    count += other.count;
  }
};

/// Measures the errors of decoded volumes, slice by slice. Missing voxels do not count.
class ErrorMeter {
 public:
  ErrorMeter(const ReadSamples& read, Extent extent, unsigned threads, Ranks& ranks, Progress* progress)
      : read_(read), extent_(extent), threads_(threads), ranks_(ranks), progress_(progress) {}

  /// Measures the error of the samples restored from the coefficients of `write`. If `corrections` is given, adds the
  /// correction steps that keep `most_error`, and measures the error after them. Returns an error if the samples cannot
  /// be read, or if cancelled. The result has no number of chunks. Each rank measures its slabs, for which
  /// `corrections` must be. All return the same error.
  [[nodiscard]] std::variant<ValueError, EncodeError> measure(const SliceRestorer::WriteBlock& write,
                                                              std::uint32_t most_error, RemainderEncoder* corrections);

 private:
  std::optional<EncodeError> add_errors(const SliceRestorer::WriteBlock& write, std::uint32_t most_error,
                                        RemainderEncoder* corrections, ErrorSum& whole);

  const ReadSamples& read_;
  Extent extent_;
  unsigned threads_;
  Ranks& ranks_;
  Progress* progress_;
};

}  // namespace gs::qnv::values
