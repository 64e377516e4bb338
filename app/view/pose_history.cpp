#include "app/view/pose_history.h"

#include <utility>

namespace gs::app {
namespace {

bool same_place(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation == b.orientation && a.height == b.height;
}

}  // namespace

void PoseHistory::moved(const Pose& from, const Pose& to, double now) {
  const bool begins = now - std::exchange(last_, now) > kRest;
  if (taken_) {
    if (goal_ && same_place(to, *goal_)) {
      taken_ = false;
      last_ = -1e9;  // so that the next movement starts a new entry
    }
    return;
  }
  if (!begins) return;
  if (behind_.size() >= kMaxPlaces) behind_.erase(behind_.begin());
  behind_.push_back({from, now});
  ahead_.clear();
}

std::optional<Pose> PoseHistory::go(int direction, const Pose& from) {
  std::vector<Entry>&places = direction < 0 ? behind_ : ahead_, &others = direction < 0 ? ahead_ : behind_;
  if (places.empty()) return std::nullopt;
  // During a transition of go(), store its goal instead of the present pose.
  others.push_back({taken_ && goal_ ? *goal_ : from, places.back().time});
  goal_ = places.back().pose;
  places.pop_back();
  taken_ = !same_place(from, *goal_);
  last_ = -1e9;
  return goal_;
}

std::optional<double> PoseHistory::time_of(int direction) const {
  const std::vector<Entry>& places = direction < 0 ? behind_ : ahead_;
  return places.empty() ? std::nullopt : std::optional(places.back().time);
}

}  // namespace gs::app
