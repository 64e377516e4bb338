#include "app/view/derived/step_content.h"

#include "app/formats/qnv/geometry_reader.h"
#include "base/budget.h"

#include <chrono>
#include <utility>

namespace gs::app {

StepContent::Shared StepContent::get(const Shared& of, const qnv::ShownComponent& wish) {
  const auto* const volume = of ? of->as<qnv::Volume>() : nullptr;
  asked_ = wish;
  if (!volume || !volume->series) return nullptr;
  if (series_.lock() != volume->series) {
    series_ = volume->series;
    content_.reset();
  }
  const std::uint64_t revision = volume->series->revision();
  const bool newest = content_ && shown_ == wish && revision_ == revision;
  if (!newest && !coming_.valid())
    coming_ = std::async(std::launch::async, [series = volume->series, of, wish, revision]() -> Made {
      qnv::Geometry made = series->step(wish);
      made.base().requests = of->base().requests;
      return {hold_geometry(std::move(made), own_budget()), wish, revision};
    });
  return content_;
}

bool StepContent::take() {
  if (!coming_.valid() || coming_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  Made made = coming_.get();
  if (made.geometry) content_ = std::move(made.geometry);
  shown_ = made.wish;
  revision_ = made.revision;
  return true;
}

}  // namespace gs::app
