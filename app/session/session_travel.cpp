#include "app/session/session.h"

#include <utility>

// Histories of the viewports: visits, back and forward.
namespace gs::app {

// Records a visit for each visible file that was opened other than by back or forward.
void Session::note_visits() {
  for (const std::size_t i : panes_.visible()) {
    Pane& pane = panes_.at(i);
    View* seen = pane.view();
    if (!seen || pane.shown != pane.wanted) continue;
    TravelHistory& history = histories_[i];
    if (history.current() != pane.shown) {
      const auto before = pane.views.find(std::string(history.current()));
      history.visit(pane.shown,
                    before == pane.views.end() ? std::optional<Pose>() : std::optional(before->second.navigation.pose));
    }
    const auto place = returning_.find(i);
    if (place == returning_.end() || panes_.loading(i)) continue;
    if (place->second.path == pane.shown && place->second.pose) {
      choose_parallel(*seen, place->second.pose->height > 0);
      stand_at(*seen, *place->second.pose, false);
    }
    returning_.erase(place);
  }
}

void Session::stand_at(View& seen, const Pose& pose, bool on_a_way) {
  if (seen.navigation.mode == NavigationMode::none) return;
  seen.navigation = travel_to(seen.navigation, pose, !on_a_way);
  if (on_a_way) return;
  seen.navigation.pose = pose;
  seen.navigation.transition.reset();
}

bool Session::can_travel(int direction) const { return histories_[panes_.active()].can_go(direction); }

void Session::travel(int direction) {
  const std::size_t active = panes_.active();
  View* seen = view();
  const auto visit =
      histories_[active].go(direction, seen ? std::optional(seen->navigation.pose) : std::optional<Pose>());
  if (!visit) return;
  if (seen && visit->path == panes_.at(active).shown && panes_.at(active).wanted == visit->path) {
    stand_at(*seen, visit->pose.value_or(seen->home), true);
  } else {
    show_at(visit->path, visit->pose);
  }
}

// Shows a file at a pose. A listed file is not read again.
void Session::show_at(const std::string& path, const std::optional<Pose>& pose) {
  frame_.files_chosen = true;
  returning_[panes_.active()] = {path, pose};
  const auto& entries = panes_.documents().entries();
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (entries[i].path == path) return panes_.select(i);
  panes_.open(std::vector<std::string>{path});
}

void Session::open_at(const std::string& place, const std::string& viewpoint, const std::optional<Pose>& pose) {
  const std::vector<std::string> places = places_of({place});
  if (places.empty()) return;
  if (!viewpoint.empty()) entries_[places.front()] = viewpoint;
  load_.allowed.insert(load_.allowed.end(), places.begin(), places.end());
  show_at(places.front(), pose);
}

void Session::set_speed(double factor) {
  const double change = factor / std::exchange(options_.speed, factor);
  for (std::size_t i = 0; i < kMostViewports; ++i)
    for (auto& [path, seen] : panes_.at(i).views) seen.navigation.speed *= static_cast<float>(change);
}

}  // namespace gs::app
