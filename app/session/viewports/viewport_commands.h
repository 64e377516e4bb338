#pragma once

#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "app/view/actions.h"
#include "app/view/panes/pane_request.h"

#include <cstddef>

namespace gs::app {

/// Commands of the user for viewports: splitting, closing, swapping and linking. One thread.
class ViewportCommands {
 public:
  ViewportCommands(StepContext& step, SessionViewports& viewports) : step_(step), viewports_(viewports) {}

  /// Serves a request of the user about a viewport. Opening::open_again() serves PaneRequest::Kind::open_again.
  void serve(const PaneRequest& request);
  /// Runs an action about viewports. Returns false for other actions.
  bool run(Action action);

 private:
  void split_viewport(std::size_t pane, SplitAxis axis);
  void close_viewport(std::size_t pane);
  void toggle_link();

  StepContext& step_;
  SessionViewports& viewports_;
};

}  // namespace gs::app
