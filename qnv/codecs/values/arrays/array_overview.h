#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/values/arrays/array_levels.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace gs::qnv::values {

/// Coarse level of an array as a whole. Reads it block by block. The first blocks are spread over the whole array, so
/// that a picture is available early. If the coarse level decodes all chunks of the array, reads the next finer level
/// instead, at no extra cost. One thread at a time.
class ArrayOverview : NonCopyable {
 public:
  /// `levels` must stay valid.
  explicit ArrayOverview(const ArrayLevels& levels);
  /// Sets all samples from kept() of a former overview. Returns false if their number is wrong.
  bool restore(std::vector<float> samples);

  /// Reads blocks until all are read, or `stop` returns true. Returns false if a block could not be read. The
  /// samples of that block are then missing.
  bool read(const std::function<bool()>& stop);
  [[nodiscard]] bool complete() const { return next_ == order_.size(); }
  [[nodiscard]] bool good() const { return good_; }
  /// Returns the share of the blocks that were read, 0 to 1.
  [[nodiscard]] double progress() const;
  /// Returns the samples of the coarsest level, x first. Samples of missing blocks are interpolated from the means of
  /// the blocks around.
  [[nodiscard]] std::vector<float> samples() const;
  /// Returns the level that is read, and its samples. Those of missing blocks are NaN.
  [[nodiscard]] int level() const { return level_; }
  [[nodiscard]] const std::vector<float>& kept() const { return samples_; }

 private:
  [[nodiscard]] SampleBox box_of(std::uint32_t block) const;
  /// Calls visit(index in the coarsest level, index in level()) for all coarse samples in a box of level().
  template <class Visit>
  void visit_coarse(const SampleBox& box, const Visit& visit) const;
  [[nodiscard]] std::uint32_t spacing() const;
  void fill(std::vector<float>& samples, const SampleBox& box, std::uint32_t spacing) const;

  void fill_slices(std::vector<float>& samples) const;

  const ArrayLevels& levels_;
  const int level_;
  const Extent extent_;
  Extent edge_{}, count_{};
  Extent coarse_{}, step_{1, 1, 1};  // samples of the coarsest level, and their distances in the level that is read
  std::vector<std::uint32_t> order_;  // numbers of blocks
  std::vector<float> means_;          // of the blocks; NaN means no values
  std::vector<std::uint8_t> read_;    // of the blocks
  std::vector<float> samples_;
  std::size_t next_ = 0;
  bool good_ = true;
};

}  // namespace gs::qnv::values
