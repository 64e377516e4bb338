#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/bricks/received/cluster_chunks.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>

namespace gs::qnv::values {

/// Decoded blocks of a stream, numbered over all steps of a time series. One thread at a time.
class BlockCache : NonCopyable {
 public:
  explicit BlockCache(const BlockLayout& layout) : layout_(layout) {}

  /// Decodes all received clusters of these blocks.
  void decode(std::span<const std::uint64_t> blocks, const ClusterChunks& chunks);
  /// Returns a block, or null if none of its clusters was decoded.
  [[nodiscard]] const Block* find(std::uint64_t block) const;
  /// Reports whether a block is a difference to that of the step before.
  [[nodiscard]] bool differs(std::uint64_t block) const;
  /// Reports whether all clusters of a block with known places were decoded.
  [[nodiscard]] bool whole(std::uint64_t block, const ClusterChunks& chunks) const;
  /// Drops the blocks that were used least recently, down to a limit.
  void trim(std::size_t most_bytes);
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::size_t count() const { return blocks_.size(); }

  /// Returns the number of clusters of a block that can be decoded now.
  [[nodiscard]] static std::uint32_t received(std::uint64_t block, const ClusterChunks& chunks);

 private:
  struct State {
    std::unique_ptr<Block> block;
    std::uint32_t next = 0;  // index of the next cluster
    bool damaged = false;    // that cluster cannot be used
    bool differs = false;    // the block is a difference to that of the step before
    std::size_t bytes = 0;
    std::uint64_t used = 0;
  };
  void decode(std::uint64_t number, State& state, const ClusterChunks& chunks) const;

  const BlockLayout& layout_;
  std::unordered_map<std::uint64_t, State> blocks_;
  std::size_t bytes_ = 0;
  std::uint64_t time_ = 0;
};

}  // namespace gs::qnv::values
