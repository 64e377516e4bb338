#include "vrml/event_model/event_budget.h"

#include <algorithm>

namespace gs::vrml {
namespace {

// Maximum number of work elements per timestamp: about 4 million deliveries, or some tenths of a second.
constexpr std::size_t kMaxWork = std::size_t{1} << 26;
constexpr std::size_t kWorkBetweenLooks = std::size_t{1} << 14;

}  // namespace

bool EventBudget::afford(std::size_t bytes) {
  constexpr std::size_t kStep = std::size_t{64} << 10;  // bytes that are charged to the world's budget at a time
  if (afforded_ + bytes > share_.amount() && !share_.grow(std::max(bytes, kStep)) && !share_.grow(bytes)) {
    if (problem_.empty()) problem_ = "events take " + root_.budget()->refusal(Resource::nodes);
    return false;
  }
  afforded_ += bytes;
  return true;
}

bool EventBudget::has_room_for(std::size_t elements) const {
  return !halted_ && elements < kMaxWork && work_ + elements <= kMaxWork;
}

bool EventBudget::look() {
  halted_ = halted_ || root_.budget()->stopped();
  return halted_;
}

bool EventBudget::spend(std::size_t elements) {
  unlooked_ += elements;
  if (unlooked_ >= kWorkBetweenLooks) {
    unlooked_ = 0;
    (void)look();
  }
  if (has_room_for(elements)) {
    work_ += elements;
    return true;
  }
  if (problem_.empty() && !halted_) problem_ = "the events of one timestamp exceed the limit of work; skipped the rest";
  return false;
}

}  // namespace gs::vrml
