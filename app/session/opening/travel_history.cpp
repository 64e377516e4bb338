#include "app/session/opening/travel_history.h"

#include <utility>

namespace gs::app {

void TravelHistory::visit(std::string path, const std::optional<Pose>& left) {
  if (!visits_.empty()) {
    if (left) visits_[at_].pose = left;
    visits_.resize(at_ + 1);
  }
  visits_.push_back({std::move(path), std::nullopt});
  if (visits_.size() > kMaxVisits) visits_.erase(visits_.begin());
  at_ = visits_.size() - 1;
}

bool TravelHistory::can_go(int direction) const { return direction < 0 ? at_ > 0 : at_ + 1 < visits_.size(); }

std::optional<TravelHistory::Visit> TravelHistory::go(int direction, const std::optional<Pose>& left) {
  if (!can_go(direction)) return std::nullopt;
  if (left) visits_[at_].pose = left;
  at_ = direction < 0 ? at_ - 1 : at_ + 1;
  return visits_[at_];
}

std::string_view TravelHistory::current() const {
  return visits_.empty() ? std::string_view() : std::string_view(visits_[at_].path);
}

}  // namespace gs::app
