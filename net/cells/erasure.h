#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::net {

// Systematic Reed-Solomon codes over GF(256). A block has n symbols of equal size. The first k are the data, and any k
// restore the data. Longer data has several blocks. The symbols of different blocks alternate, so that a burst of
// losses affects all blocks evenly.

/// Layout of encoded data. Its three fields determine everything else, for encoder and decoder.
struct ErasureLayout {
  std::uint32_t bytes = 0;   // bytes of the data
  std::uint16_t symbol = 0;  // bytes of a symbol
  // k: source symbols of each block. Zeros pad the last block.
  std::uint8_t source = 0;
  static constexpr std::size_t kMaxSymbols = 255;  // maximum n
  static constexpr std::size_t kMaxSource = 128;
  static constexpr std::size_t kMaxBytes = std::size_t{1} << 22;

  /// Reports whether an encoder can produce this layout. Safe for untrusted values.
  [[nodiscard]] bool sound() const;
  [[nodiscard]] std::size_t blocks() const;
};

/// Returns a layout for 1 to kMaxBytes bytes of data. Symbols have `symbol` bytes, blocks at most 64 source symbols.
[[nodiscard]] ErasureLayout erasure_layout(std::size_t bytes, std::size_t symbol);

/// Returns the number of symbols to send, at most 255. Returns the smallest number for which the probability of
/// receiving fewer than `source` symbols is below `failure`. `loss` is the probability that one symbol is lost.
[[nodiscard]] std::size_t symbols_for(std::size_t source, double loss, double failure);

/// Makes symbols of data. Holds a copy of the data.
class ErasureEncoder {
 public:
  /// Copies the data. `layout` must be sound and have `data.size()` bytes.
  ErasureEncoder(std::span<const std::byte> data, ErasureLayout layout);
  [[nodiscard]] const ErasureLayout& layout() const { return layout_; }
  /// Returns a symbol of a block. `number` is 0 to 254; numbers below k return the data.
  [[nodiscard]] std::vector<std::byte> symbol(std::size_t block, std::size_t number) const;

 private:
  ErasureLayout layout_;
  std::vector<std::byte> data_;  // data, padded to whole blocks
  std::vector<unsigned char> matrix_;  // 255 rows of k elements
};

/// Restores data from symbols in any order. Memory: at most twice the data. Safe for untrusted symbols. Wrong symbols
/// give wrong data, so the owner must check the data.
class ErasureDecoder {
 public:
  /// Begins without symbols. `layout` must be sound.
  explicit ErasureDecoder(ErasureLayout layout);
  [[nodiscard]] const ErasureLayout& layout() const { return layout_; }
  /// Adds a symbol. Returns true if the symbol was new and needed.
  bool add(std::size_t block, std::size_t number, std::span<const std::byte> symbol);
  [[nodiscard]] bool done() const { return done_ == blocks_.size(); }
  /// Reports whether all data of a block is restored.
  [[nodiscard]] bool done(std::size_t block) const { return block < blocks_.size() && blocks_[block].done; }
  /// Returns all data. Valid only if `done()` is true for all of it.
  [[nodiscard]] const std::vector<std::byte>& data() const { return data_; }

 private:
  struct Block {
    bool done = false;
    std::map<std::uint8_t, std::vector<std::byte>> symbols;  // received symbols by number, until done
  };
  void solve(std::size_t number);

  ErasureLayout layout_;
  std::size_t done_ = 0;
  std::vector<Block> blocks_;
  std::vector<std::byte> data_;
};

}  // namespace gs::net
