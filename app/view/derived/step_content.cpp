#include "app/view/derived/step_content.h"

#include "app/formats/qnv/geometry_reader.h"
#include "base/budget.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace gs::app {

StepContent::Shared StepContent::get(const Shared& of, const qnv::ShownComponent& wish) {
  const auto* const volume = of ? of->as<qnv::Volume>() : nullptr;
  ready_ = false;
  if (!volume || !volume->series) return nullptr;
  if (series_.lock() != volume->series) {
    series_ = volume->series;
    made_.clear();
  }
  const std::uint64_t revision = volume->series->revision();
  const auto found = std::ranges::find(made_, wish, &Made::wish);
  ready_ = found != made_.end();
  if (!coming_.valid() && (!ready_ || found->revision != revision))
    coming_ = std::async(std::launch::async, [series = volume->series, of, wish, revision]() -> Made {
      qnv::Geometry made = series->step(wish);
      made.base().requests = of->base().requests;
      return {hold_geometry(std::move(made), own_budget()), wish, revision, series};
    });
  if (ready_ && found->geometry) return found->geometry;
  return made_.empty() ? nullptr : made_.back().geometry;
}

bool StepContent::take() {
  if (!coming_.valid() || coming_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  Made made = coming_.get();
  if (made.series.lock() != series_.lock()) return true;  // the document was replaced
  if (!made.geometry && !made_.empty()) {
    // Without the other steps, there may be enough memory.
    made_.clear();
    return true;
  }
  std::erase_if(made_, [&](const Made& one) { return one.wish == made.wish; });
  if (made_.size() >= kMostSteps) made_.erase(made_.begin());
  made_.push_back(std::move(made));
  return true;
}

}  // namespace gs::app
