#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/shared/volume_detail.h"
#include "qnv/codecs/values/arrays/array_bricks.h"
#include "qnv/codecs/values/arrays/array_levels.h"
#include "qnv/codecs/values/arrays/array_overview.h"
#include "qnv/codecs/values/bricks/brick_decoder.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::qnv {

/// Volume in a file that is larger than memory, or takes long to read. Reads an overview as a whole, and bricks of
/// finer levels where views need them. In a window, another thread reads the most wanted bricks first. It drops the
/// remaining bricks of a view that changes. It begins when the overview has no large gaps, or after kOverviewFirst; for
/// slices and points, it begins at once. Any thread. Safe for untrusted values.
class ArrayVolume final : public VolumeDetail {
 public:
  static constexpr std::chrono::milliseconds kPatience{20'000}, kOverviewFirst{10'000};
  /// `source` must satisfy suits(). Reads nothing yet. A cut() that waits for its bricks ends after `patience`, with
  /// the bricks that were read.
  ArrayVolume(VolumeSource source, const BrickLimits& limits, std::chrono::milliseconds patience = kPatience);
  ~ArrayVolume() override;

  /// Reports whether a volume can be shown in bricks: it has no labels or colours, and more voxels than an overview.
  [[nodiscard]] static bool suits(const VolumeSource& source, std::size_t most_vectors);

  /// Reads the overview until it is complete, or for `patience`, or until `stop` returns true. Returns false if the
  /// overview has no values. One thread at a time.
  bool read_overview(std::chrono::milliseconds patience, const std::function<bool()>& stop);
  /// Restores the overview from a former kept_overview(); read_overview() shows it. Returns false on a wrong size.
  bool restore_overview(std::vector<float> samples);
  [[nodiscard]] bool has_overview() const;
  /// Reports whether the overview is complete and no part of it failed to load.
  [[nodiscard]] bool has_whole_overview() const;
  /// Returns the samples of the overview, for another ArrayVolume. It must be complete.
  [[nodiscard]] const std::vector<float>& kept_overview() const { return overview_.kept(); }
  /// Returns the share of the overview that was read, 0 to 1.
  [[nodiscard]] double progress() const;

  [[nodiscard]] std::shared_ptr<const Volume> cut(const LodView& view, bool& pending) override;
  [[nodiscard]] std::shared_ptr<const Volume> latest() const override;
  [[nodiscard]] std::uint64_t revision() const override;
  /// Returns the volume of the overview as far as it was read, or null.
  [[nodiscard]] std::shared_ptr<const Volume> overview() const;
  [[nodiscard]] BrickStatistics statistics() const;
  /// Returns a message about parts that could not be read; empty if there are none.
  [[nodiscard]] std::string trouble() const;

 private:
  /// Snapshot of the overview, with its vectors.
  struct Base {
    std::shared_ptr<const std::vector<float>> samples;
    std::shared_ptr<const Volume> volume;
    values::VectorShares shares;
    values::KnownLevel known;
    std::uint64_t version = 0;
  };
  bool show_overview();
  /// Reports whether bricks may be read before the overview is complete.
  [[nodiscard]] bool may_read_bricks(const LodView& view) const;
  void work(bool beside);
  void publish(const Base& base, const std::vector<LodView>& views);
  [[nodiscard]] std::shared_ptr<const Volume> merged(const Base& base, std::span<const values::BrickName> ready,
                                                     bool with_values) const;

  const BrickLimits limits_;
  const std::chrono::milliseconds patience_;
  const values::ArrayLevels levels_;
  const values::BrickLayout layout_;
  values::ArrayOverview overview_;  // used by one thread at a time
  values::ArrayBricks bricks_;      // used by one call of work() at a time
  static constexpr std::size_t kMostTogether = 8;
  std::size_t together_ = 1;  // bricks to read with one request; of work()

  mutable std::mutex mutex_;  // guards all members below
  std::optional<std::chrono::steady_clock::time_point> began_;  // start of the first read_overview()
  double known_part_ = 0;                                       // share of known samples in the shown overview
  std::shared_ptr<const Base> base_;
  std::vector<LodView> views_;  // one per viewport, the latest last
  bool working_ = false;
  std::shared_ptr<const Volume> shown_;
  BrickStatistics statistics_;
  std::uint64_t revision_ = 0;
  std::size_t failures_ = 0;
  std::future<void> running_;
  std::atomic<bool> stale_{false};  // the views have changed since the bricks were chosen
  std::atomic<bool> stop_{false};
};

}  // namespace gs::qnv
