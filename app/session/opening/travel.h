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

/// Histories of the files and positions that each viewport showed, with back and forward. One thread.
class Travel {
 public:
  Travel(SessionViewports& viewports, Opening& opening) : viewports_(viewports), opening_(opening) {}

  /// Records visits of newly opened files, except those opened by going back or forward. After a file has loaded, moves
  /// the viewer to the pose that go() or open_at() set.
  void note_visits();
  /// Records the viewer's present pose, because a link leads to another Viewpoint of the same file.
  void leave(std::size_t pane, const View& view) {
    histories_[pane].visit(viewports_.panes().at(pane).shown, view.navigation.pose);
  }
  /// Returns true if the active viewport's history has an entry before (-1) or after (1) the current one.
  [[nodiscard]] bool can_go(int direction) const;
  /// Goes back (-1) or forward (1) in the history of the active viewport.
  void go(int direction);
  /// Opens a file or URL in the active viewport. The viewer goes to `viewpoint` if that is not empty. Otherwise it goes
  /// to `pose` after everything has loaded. If neither is set, the view is the last one of the file or its initial
  /// view.
  void open_at(const std::string& place, const std::string& viewpoint, const std::optional<Pose>& pose);
  /// Removes the history of a viewport. Call when the viewport is closed.
  void forget(std::size_t pane);

 private:
  void show_at(const std::string& path, const std::optional<Pose>& pose);

  SessionViewports& viewports_;
  Opening& opening_;
  std::array<TravelHistory, kMaxViewports> histories_;  // by index of the viewport
  std::map<std::size_t, TravelHistory::Visit> returning_;  // visits to restore after loading, by viewport
};

}  // namespace gs::app
