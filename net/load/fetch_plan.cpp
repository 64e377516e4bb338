#include "net/load/fetch_plan.h"

#include <algorithm>
#include <array>

namespace gs::net {

void FetchPlan::add(const RangeSet& missing) {
  for (const ByteRange& range : missing.joined(join_gap_)) {
    auto fetch = std::make_unique<Fetch>();
    fetch->range = range;
    fetch->position = range.begin;
    fetches_.push_back(std::move(fetch));
  }
}

void FetchPlan::cover(const RangeSet& needed) {
  RangeSet planned;
  for (const auto& fetch : fetches_)
    if (!fetch->finished) planned.add({fetch->position, fetch->range.end});
  add(needed.without(planned));
}

void FetchPlan::add_conditional(ByteRange range) {
  add(RangeSet(std::array{range}));
  fetches_.back()->conditional = true;
}

bool FetchPlan::is_first_unfinished(const Fetch& fetch) const {
  const auto first = std::find_if(fetches_.begin(), fetches_.end(), [](const auto& other) { return !other->finished; });
  return first != fetches_.end() && first->get() == &fetch;
}

unsigned FetchPlan::attempts() const {
  unsigned result = 0;
  for (const auto& fetch : fetches_) result = std::max(result, fetch->attempts);
  return result;
}

void FetchPlan::delay(TimePoint not_before, unsigned attempts) {
  for (const auto& fetch : fetches_)
    if (!fetch->finished) {
      fetch->not_before = not_before;
      fetch->attempts = attempts;
    }
}

void FetchPlan::stop(Fetch& fetch) {
  if (fetch.transfer) cancel_(fetch.transfer);
  fetch.transfer = 0;
}

void FetchPlan::stop_all() {
  for (const auto& fetch : fetches_) stop(*fetch);
}

void FetchPlan::finish_others(const Fetch* kept) {
  for (const auto& fetch : fetches_)
    if (fetch.get() != kept) {
      stop(*fetch);
      fetch->finished = true;
    }
}

void FetchPlan::erase_finished() {
  std::erase_if(fetches_, [](const auto& fetch) { return fetch->finished && !fetch->transfer; });
}

}  // namespace gs::net
