#pragma once

#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/decode/sample_levels.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace gs::qnv::values {

/// Reports whether a volume of this extent is supported: no axis is empty, and at most kMostSamples samples.
[[nodiscard]] bool valid(Extent extent);

/// Maximum number of decoded samples per permitted vector. About 9 % of the samples become vectors.
inline constexpr std::size_t kSamplesPerVector = 8;
/// Returns the finest level that a decoder for this number of vectors decodes as a whole; 0 means the volume.
[[nodiscard]] int level_for(Extent extent, std::size_t most_vectors);

/// Result of adding a cluster.
enum class Added : std::uint8_t { taken, waits, repeated, refused, dropped };

/// Decoder of the clusters of one volume, in any order. A cluster waits until those before it in its block are
/// received. Safe for untrusted clusters. One thread at a time.
class ValuesDecoder {
 public:
  /// Drops clusters that only refine samples beyond level `finest`. After `most_blocks` blocks, drops clusters of new
  /// blocks. `extent` must be valid.
  explicit ValuesDecoder(Extent extent, int finest = 0, std::size_t most_blocks = std::size_t{1} << 22);

  ~ValuesDecoder();
  ValuesDecoder(const ValuesDecoder&) = delete;
  ValuesDecoder& operator=(const ValuesDecoder&) = delete;

  /// Makes this the step of a time series after `before`: its blocks replace those of that step, or are added to them.
  /// Call it before add(). `before` must outlive this decoder, and be used by the same thread.
  void refer(ValuesDecoder& before);
  [[nodiscard]] bool refers() const { return before_ != nullptr; }
  /// Drops the samples. Functions that need them compute them again.
  void rest() { restored_ = SampleLevels(extent_, levels_); }

  Added add(const Cluster& cluster);
  /// Decodes the coefficients of all added clusters, several blocks at once. Functions that need them call it.
  void decode_ready();
  [[nodiscard]] int levels() const { return levels_; }
  /// Returns the level to show: the finest one that is not dropped, and has data or takes little time. 0 means the
  /// volume.
  [[nodiscard]] int level() const;
  /// Returns the samples of low_extent(extent, level), x first. The samples of level n are larger by level_gain(n).
  [[nodiscard]] std::vector<std::int32_t> samples(int level = 0);
  /// Computes the same samples, but only those that changed since its last call. `changed` gets boxes with all of them.
  [[nodiscard]] SampleBricks bricks(int level, std::vector<SampleBox>& changed);

 private:
  struct State {
    std::unique_ptr<Block> block;
    bool differs = false;        // the block is added to that of the step before
    std::uint32_t next = 0;      // index of the next cluster
    std::vector<Cluster> ready;  // clusters before it that are not decoded yet
    std::map<std::uint32_t, Cluster> waiting;
  };
  void take(State& state, const Cluster& cluster, const BlockPlace& place);
  [[nodiscard]] int own_level() const;
  [[nodiscard]] BlockChain blocks_of(std::uint64_t number) const;
  void note(const Block& block, std::size_t first, std::size_t steps);

  Extent extent_;
  int levels_, finest_;
  BlockLayout layout_;
  std::map<std::uint32_t, State> states_;
  std::vector<std::uint32_t> begun_;  // number of blocks with data, by BlockPlace::level
  std::uint64_t bytes_ = 0;           // of clusters that do not wait
  std::size_t waiting_ = 0;           // clusters
  std::size_t most_blocks_;
  std::vector<std::uint32_t> ready_;  // blocks with clusters that are not decoded yet
  std::size_t ready_bytes_ = 0;       // memory of these clusters
  SampleLevels restored_;
  ValuesDecoder *before_ = nullptr, *after_ = nullptr;  // steps of a time series
};

/// Returns the factor by which samples of a level exceed those of the volume.
[[nodiscard]] double level_gain(Extent extent, int level);

}  // namespace gs::qnv::values
