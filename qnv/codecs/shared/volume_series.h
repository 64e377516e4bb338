#pragma once

#include "qnv/base/geometry.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstdint>
#include <span>

namespace gs::qnv {

/// All steps of a time series of volumes, as far as they were received. Any thread.
class VolumeSeries {
 public:
  VolumeSeries() = default;
  VolumeSeries(const VolumeSeries&) = delete;
  VolumeSeries& operator=(const VolumeSeries&) = delete;
  virtual ~VolumeSeries() = default;

  /// Returns the times of the steps, ascending.
  [[nodiscard]] virtual std::span<const double> times() const = 0;
  /// Decodes a step. Fastest for the steps after the one before. Blocks.
  [[nodiscard]] virtual Geometry step(const ShownComponent& shown) = 0;
  /// Returns a number that changes when more of the stream was received.
  [[nodiscard]] virtual std::uint64_t revision() const = 0;
};

}  // namespace gs::qnv
