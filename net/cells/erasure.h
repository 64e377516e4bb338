#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::net {

// Systematic Reed-Solomon codes over GF(256): of n symbols of one size, the
// first k are the data, and any k give them back. Longer data are cut into
// blocks; symbols of different blocks take turns, so that a burst hurts all a
// little.

/// How data are cut. From the first three numbers follows all else, on both
/// sides.
struct ErasureLayout {
  std::uint32_t bytes = 0;                          // of the data
  std::uint16_t symbol = 0;                         // bytes of a symbol
  std::uint8_t source = 0;                          // k: source symbols of a block, the last block's too
                                                    // (it is filled up with zeros)
  static constexpr std::size_t kMostSymbols = 255;  // n
  static constexpr std::size_t kMostSource = 128;
  static constexpr std::size_t kMostBytes = std::size_t{1} << 22;

  /// False for numbers that no encoder gives: for layouts from outside.
  [[nodiscard]] bool sound() const;
  [[nodiscard]] std::size_t blocks() const;
};

/// A layout for data of 1 to kMostBytes bytes in symbols of `symbol` bytes, at
/// most 64 of them in a block.
[[nodiscard]] ErasureLayout erasure_layout(std::size_t bytes, std::size_t symbol);

/// The least n such that fewer than k of n symbols arrive with a probability
/// below `failure` when each is lost with probability `loss`; at most 255.
[[nodiscard]] std::size_t symbols_for(std::size_t source, double loss, double failure);
/// That probability.
[[nodiscard]] double failure_of(std::size_t source, std::size_t symbols, double loss);

/// Makes symbols. Holds the data.
class ErasureEncoder {
 public:
  /// `layout` sound and of `data.size()` bytes.
  ErasureEncoder(std::span<const std::byte> data, ErasureLayout layout);
  [[nodiscard]] const ErasureLayout& layout() const { return layout_; }
  /// Symbol `number` (0 to 254; below k they are the data) of a block.
  [[nodiscard]] std::vector<std::byte> symbol(std::size_t block, std::size_t number) const;

 private:
  ErasureLayout layout_;
  std::vector<std::byte> data_;        // filled up to whole blocks
  std::vector<unsigned char> matrix_;  // 255 rows of k
};

/// Takes symbols in any order. Memory: the data, once or twice. Safe for
/// untrusted symbols: wrong bytes give wrong data, which the owner must check.
class ErasureDecoder {
 public:
  /// `layout` sound.
  explicit ErasureDecoder(ErasureLayout layout);
  [[nodiscard]] const ErasureLayout& layout() const { return layout_; }
  /// True when the symbol was new and of use.
  bool add(std::size_t block, std::size_t number, std::span<const std::byte> symbol);
  [[nodiscard]] bool done() const { return done_ == blocks_.size(); }
  /// Bit per block: done.
  [[nodiscard]] bool done(std::size_t block) const { return block < blocks_.size() && blocks_[block].done; }
  /// Of how many symbols one block still lacks most.
  [[nodiscard]] std::size_t missing() const;
  /// All data, once `done()`.
  [[nodiscard]] const std::vector<std::byte>& data() const { return data_; }

 private:
  struct Block {
    bool done = false;
    std::map<std::uint8_t, std::vector<std::byte>> symbols;  // until done
  };
  void solve(std::size_t number);

  ErasureLayout layout_;
  std::size_t done_ = 0;
  std::vector<Block> blocks_;
  std::vector<std::byte> data_;
};

}  // namespace gs::net
