#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

namespace gs::bench {

/// What a program could reach that did nothing but turn the numbers of a text into binary ones: fast_float for
/// reals, a plain loop for integers, both written to memory that is already there. It builds nothing, checks nothing
/// and knows of VRML only that a word ending in "Index" is followed by integers. The bar that a parser is held to.
class BareLoop {
 public:
  /// Makes room for the numbers of any text of up to `bytes`, and touches it.
  explicit BareLoop(std::size_t bytes);

  /// Returns how many numbers were read.
  std::size_t run(std::string_view text);

 private:
  std::size_t capacity_;
  std::unique_ptr<float[]> reals_;
  std::unique_ptr<std::int32_t[]> integers_;
};

/// The sum of all 8-byte words: how fast memory can be read at all.
[[nodiscard]] std::uint64_t sum_words(std::string_view text);

}  // namespace gs::bench
