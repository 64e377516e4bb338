#pragma once

#include "app/session/opening/opening.h"
#include "app/session/opening/travel_history.h"
#include "app/session/viewports/session_viewports.h"

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace gs::app {

/// Histories of the viewports: visits, back and forward. One thread.
class Travel {
 public:
  Travel(SessionViewports& viewports, Opening& opening) : viewports_(viewports), opening_(opening) {}

  /// Records a visit for each visible file that was opened other than by back or forward. Moves viewers to the poses
  /// of `go` and `open_at` once their files are loaded.
  void note_visits();
  /// Records that a link leads from this viewer to another Viewpoint of its file.
  void leave(std::size_t pane, const View& view) {
    histories_[pane].visit(viewports_.panes().at(pane).shown, view.navigation.pose);
  }
  /// Returns true if the history of the active viewport has an entry before (-1) or after (1) the current one.
  [[nodiscard]] bool can_go(int direction) const;
  /// Moves the active viewport back (-1) or forward (1) in its history.
  void go(int direction);
  /// Opens a file or URL in the active viewport. A non-empty `viewpoint` selects the Viewpoint; else `pose` places the
  /// viewer once everything is loaded. With neither, the view is the initial one or the last one.
  void open_at(const std::string& place, const std::string& viewpoint, const std::optional<Pose>& pose);
  /// Removes the history of a closed viewport.
  void forget(std::size_t pane);

 private:
  void show_at(const std::string& path, const std::optional<Pose>& pose);

  SessionViewports& viewports_;
  Opening& opening_;
  std::array<TravelHistory, kMaxViewports> histories_;     // by viewport
  std::map<std::size_t, TravelHistory::Visit> returning_;  // poses of viewers once their files are loaded
};

}  // namespace gs::app
