#include "app/session/opening/travel.h"

#include "app/session/navigation/camera_control.h"

namespace gs::app {

void Travel::note_visits() {
  Panes& panes = viewports_.panes();
  for (const std::size_t i : panes.visible()) {
    Pane& pane = panes.at(i);
    View* seen = pane.view();
    if (!seen || pane.shown != pane.wanted) continue;
    TravelHistory& history = histories_[i];
    if (history.current() != pane.shown) {
      const auto before = pane.views.find(std::string(history.current()));
      history.visit(pane.shown,
                    before == pane.views.end() ? std::optional<Pose>() : std::optional(before->second.navigation.pose));
    }
    const auto place = returning_.find(i);
    if (place == returning_.end() || panes.loading(i)) continue;
    if (place->second.path == pane.shown && place->second.pose) {
      choose_parallel(*seen, place->second.pose->height > 0);
      stand_at(*seen, *place->second.pose, false);
    }
    returning_.erase(place);
  }
}

bool Travel::can_go(int direction) const { return histories_[viewports_.panes().active()].can_go(direction); }

void Travel::go(int direction) {
  const std::size_t active = viewports_.panes().active();
  const Pane& pane = viewports_.panes().at(active);
  View* seen = viewports_.view();
  const auto visit =
      histories_[active].go(direction, seen ? std::optional(seen->navigation.pose) : std::optional<Pose>());
  if (!visit) return;
  if (seen && visit->path == pane.shown && pane.wanted == visit->path)
    stand_at(*seen, visit->pose.value_or(seen->home), true);
  else
    show_at(visit->path, visit->pose);
}

void Travel::show_at(const std::string& path, const std::optional<Pose>& pose) {
  returning_[viewports_.panes().active()] = {path, pose};
  opening_.show(path);
}

void Travel::open_at(const std::string& place, const std::string& viewpoint, const std::optional<Pose>& pose) {
  const auto target = opening_.allowed_target(place);
  if (!target) return;
  if (!viewpoint.empty()) opening_.enter_at(*target, viewpoint);
  show_at(*target, pose);
}

void Travel::forget(std::size_t pane) {
  histories_[pane] = {};
  returning_.erase(pane);
}

}  // namespace gs::app
