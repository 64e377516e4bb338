#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/shared/volume_series.h"

#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <vector>

namespace gs::app {

/// Steps of a time series of volumes, which another thread decodes. The step before stays until the next one is ready.
/// While the stream arrives, decodes steps again. Keeps a few steps, for several viewports. One thread. The destructor
/// waits for a running computation.
class StepContent : NonCopyable {
 public:
  using Shared = std::shared_ptr<const qnv::Geometry>;

  /// Returns the newest content for the step of `wish`. Until it is ready, returns another step, or null if there is
  /// none. `of` is the geometry that the document shows, which has the series.
  Shared get(const Shared& of, const qnv::ShownComponent& wish);
  /// Takes content that is ready. Returns true if there is any.
  bool take();
  [[nodiscard]] bool is_busy() const { return coming_.valid(); }
  /// Returns true if the last get() returned the step that it asked for.
  [[nodiscard]] bool is_ready() const { return ready_; }

 private:
  static constexpr std::size_t kMostSteps = 4;
  struct Made {
    Shared geometry;  // null if there is not enough memory
    qnv::ShownComponent wish;
    std::uint64_t revision = 0;
    std::weak_ptr<qnv::VolumeSeries> series{};
  };

  std::weak_ptr<qnv::VolumeSeries> series_;  // of the contents
  std::vector<Made> made_;                   // the last one is the newest
  bool ready_ = false;
  std::future<Made> coming_;
};

}  // namespace gs::app
