#include "qnv/codecs/values/bricks/brick_series.h"

#include <algorithm>
#include <string>
#include <utility>

namespace gs::qnv {

BrickSeries::BrickSeries(std::shared_ptr<const ChunkSource> source, StreamHeader header, const BrickLimits& limits,
                         std::shared_ptr<const void> owner)
    : source_(std::move(source)),
      header_(std::move(header)),
      limits_(limits),
      owner_(std::move(owner)),
      opened_(header_.steps.times.size()) {
  // The coarse levels of the steps of a chain are decoded together.
  constexpr std::size_t kBasePart = 4, kBrickPart = 2;
  limits_.base_vectors = std::max<std::size_t>(1, limits_.base_vectors / kBasePart);
  limits_.brick_bytes /= kBrickPart;
}

std::variant<Volume, StreamProblem> BrickSeries::open(std::uint32_t step, const std::function<bool()>& stop) {
  const std::lock_guard lock(mutex_);
  if (step >= opened_.size()) return StreamProblem{0, "has no step " + std::to_string(step)};
  std::shared_ptr<BrickVolume> bricks = opened_[step].lock();
  if (!bricks) {
    auto opened = BrickVolume::open(source_, limits_, stop, step);
    if (auto* const problem = std::get_if<StreamProblem>(&opened)) return std::move(*problem);
    bricks = std::move(std::get<std::shared_ptr<BrickVolume>>(opened));
    opened_[step] = bricks;
  }
  Volume volume = *bricks->latest();
  volume.detail = bricks;
  volume.requests = bricks;
  volume.series = shared_from_this();
  return volume;
}

Geometry BrickSeries::step(const ShownComponent& shown) {
  auto opened = open(step_number(shown.step, times()));
  if (auto* const volume = std::get_if<Volume>(&opened)) return std::move(*volume);
  Volume none(GeometryBase{header_.description, header_.color});
  none.series = shared_from_this();
  return none;
}

}  // namespace gs::qnv
