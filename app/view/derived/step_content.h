#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/shared/volume_series.h"

#include <cstdint>
#include <future>
#include <memory>

namespace gs::app {

/// A step of a time series of volumes, which another thread decodes. The step before stays until it is ready. While the
/// stream arrives, decodes the step again. One thread. The destructor waits for a running computation.
class StepContent : NonCopyable {
 public:
  using Shared = std::shared_ptr<const qnv::Geometry>;

  /// Returns the newest content for this step, or that of another step until it is there; null if there is none. `of`
  /// is the geometry that the document shows, which has the series.
  Shared get(const Shared& of, const qnv::ShownComponent& wish);
  /// Takes content that is ready. Returns true if there is any.
  bool take();
  [[nodiscard]] bool is_busy() const { return coming_.valid(); }
  /// Returns true if the last get() returned the step that it asked for.
  [[nodiscard]] bool is_ready() const { return content_ && shown_ == asked_; }

 private:
  struct Made {
    Shared geometry;
    qnv::ShownComponent wish;
    std::uint64_t revision = 0;
  };

  std::weak_ptr<qnv::VolumeSeries> series_;  // of the content
  Shared content_;
  qnv::ShownComponent shown_, asked_;
  std::uint64_t revision_ = 0;
  std::future<Made> coming_;
};

}  // namespace gs::app
