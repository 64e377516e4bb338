#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/values/arrays/array_levels.h"
#include "qnv/codecs/values/bricks/brick_cache.h"
#include "qnv/codecs/values/bricks/brick_places.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::qnv::values {

/// Level with all samples in memory. Null samples mean that there is none.
struct KnownLevel {
  int level = 0;
  std::shared_ptr<const std::vector<float>> samples;
};

/// Bricks of an array in memory. Samples are bits of float values. One thread at a time.
class ArrayBricks : NonCopyable {
 public:
  /// Bricks to read with one request: one, or several with the same parent.
  using Group = std::vector<BrickName>;

  /// Both must stay valid.
  ArrayBricks(const ArrayLevels& levels, const BrickLayout& layout) : levels_(levels), layout_(layout) {}

  /// Sets the bricks that views need, most wanted first. While all bricks exceed `most_bytes`, drops the least recently
  /// needed other bricks.
  void choose(std::vector<BrickName> chosen, const VectorShares& shares, std::size_t most_bytes);
  /// Returns at most `most` bricks to read next: the most wanted one and its wanted neighbours with the same parent.
  /// Returns an empty group if all bricks were read or have failed.
  [[nodiscard]] Group next(std::size_t most) const;
  /// Reads bricks. Does not retry bricks that cannot be read.
  void read(const Group& group, const KnownLevel& known = {});
  /// Returns the chosen bricks that were read, each after the bricks that contain it. Completes their margins and
  /// vectors for the overview `base`, with the `shares` of its vectors.
  [[nodiscard]] std::vector<BrickName> finish(std::span<const float> base, std::uint64_t base_version,
                                              const VectorShares& shares);
  /// Returns a brick that finish() returned.
  [[nodiscard]] const Brick* find(const BrickName& name) const;
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::size_t count() const { return bricks_.size(); }
  [[nodiscard]] std::size_t failures() const { return failed_.size(); }

 private:
  struct State {
    Brick brick;
    std::uint64_t key = 0;  // of the neighbours of its margin; 0 if it has none yet
    std::uint64_t used = 0;
  };
  [[nodiscard]] SampleBox extended(const BrickName& name) const;
  [[nodiscard]] std::uint64_t key_of(const BrickName& name, std::uint64_t base_version) const;
  [[nodiscard]] bool read_box(int level, const SampleBox& box, const KnownLevel& known, std::vector<float>& values) const;
  void complete(State& state, std::span<const float> base, const VectorShares& shares, Brick& made) const;
  [[nodiscard]] float sample(int level, const Extent& at, std::span<const float> base) const;
  [[nodiscard]] const Brick* shown(const BrickName& name) const;

  const ArrayLevels& levels_;
  const BrickLayout& layout_;
  std::unordered_map<BrickName, State, BrickNameHash> bricks_;
  std::unordered_set<BrickName, BrickNameHash> failed_, shown_;
  std::vector<BrickName> chosen_;
  std::size_t bytes_ = 0;
  std::uint64_t time_ = 0;
};

}  // namespace gs::qnv::values
