#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

namespace gs::bench {

/// Lower bound for a parser: converts only the numbers of a text to binary, with fast_float for reals and a plain loop
/// for integers, into existing memory. Builds and checks nothing. It detects integers by the preceding word, which ends
/// in "Index".
class BareLoop {
 public:
  /// Allocates and touches memory for the numbers of any text of at most `bytes` bytes.
  explicit BareLoop(std::size_t bytes);

  /// Returns the count of numbers that it read.
  std::size_t run(std::string_view text);

 private:
  std::size_t capacity_;
  std::unique_ptr<float[]> reals_;
  std::unique_ptr<std::int32_t[]> integers_;
};

/// Returns the sum of all 8-byte words, which measures the speed of memory.
[[nodiscard]] std::uint64_t sum_words(std::string_view text);

}  // namespace gs::bench
