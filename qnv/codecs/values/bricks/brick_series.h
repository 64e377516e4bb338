#pragma once

#include "qnv/codecs/shared/volume_series.h"
#include "qnv/codecs/values/bricks/brick_volume.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Time series of volumes that are larger than memory, in a file. Each step that is shown is a BrickVolume of its own,
/// with half the brick memory and a quarter of the coarse vectors of a single volume. Any thread.
class BrickSeries final : public VolumeSeries, public std::enable_shared_from_this<BrickSeries> {
 public:
  /// `owner` holds the memory of the limits.
  BrickSeries(std::shared_ptr<const ChunkSource> source, StreamHeader header, const BrickLimits& limits,
              std::shared_ptr<const void> owner = nullptr);

  /// Opens a step. `stop` ends this if it returns true.
  [[nodiscard]] std::variant<Volume, StreamProblem> open(std::uint32_t step, const std::function<bool()>& stop = {});

  [[nodiscard]] std::span<const double> times() const override { return header_.steps.times; }
  /// Returns the coarse level of a step. Its detail has the bricks. Shows no vectors if the file cannot be read.
  [[nodiscard]] Geometry step(const ShownComponent& shown) override;
  /// Returns 0, because files do not change.
  [[nodiscard]] std::uint64_t revision() const override { return 0; }

 private:
  const std::shared_ptr<const ChunkSource> source_;
  const StreamHeader header_;
  BrickLimits limits_;
  const std::shared_ptr<const void> owner_;
  std::mutex mutex_;                                // guards the member below
  std::vector<std::weak_ptr<BrickVolume>> opened_;  // by step, those that are shown
};

}  // namespace gs::qnv
