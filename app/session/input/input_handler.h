#pragma once

#include "app/session/input/pointing.h"
#include "app/session/navigation/camera_control.h"
#include "app/session/navigation/session_sound.h"
#include "app/session/opening/link_follower.h"
#include "app/session/opening/opening.h"
#include "app/session/opening/travel.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "app/session/viewports/viewport_commands.h"
#include "app/view/actions.h"

namespace gs::app {

/// Parts of a session that input can affect.
struct InputTargets {
  SessionViewports& viewports;
  Opening& opening;
  LinkFollower& links;
  Travel& travel;
  CameraControl& camera;
  Pointing& pointing;
  SessionSound& sound;
};

/// Dispatcher of the user's events and actions to the parts of a session. One thread.
class InputHandler {
 public:
  InputHandler(StepContext& step, InputTargets targets)
      : step_(step), to_(targets), viewport_commands_(step, targets.viewports) {}

  void handle(const SessionInput::Event& event);
  /// Runs an action. Returns false if the session has no such action, or nothing to which it applies.
  bool run(Action action);
  /// Serves a request about a viewport.
  void serve(const PaneRequest& request);

 private:
  void handle_key(const WindowEvent& event);
  void handle_axes(const WindowEvent& event);
  void handle_pointer(const SessionInput::Event& event);
  void release(const WindowEvent& event);
  bool select_next_file(Action action);

  StepContext& step_;
  InputTargets to_;
  ViewportCommands viewport_commands_;
};

}  // namespace gs::app
