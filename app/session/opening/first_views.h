#pragma once

#include "app/session/navigation/camera_control.h"
#include "app/session/opening/link_follower.h"
#include "app/session/opening/opening.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "app/view/picking.h"

#include <optional>
#include <string>

namespace gs::app {

/// Settings of the first view of a file.
struct FirstViewOptions {
  std::string viewpoint;          // description, DEF name or number of the initial Viewpoint
  std::optional<bool> headlight;  // overrides the worlds' NavigationInfo
  std::optional<Pose> camera;     // initial camera of the first file
};

/// First views of files that were read. One thread.
class FirstViews {
 public:
  FirstViews(StepContext& step, SessionViewports& viewports, CameraControl& camera, Opening& opening,
             LinkFollower& links, Picker& picker, FirstViewOptions options);

  /// Shows files that were read in the viewports that wait for them, and enters them where their links lead.
  void show();

 private:
  void set_up(View& view, const Pane& pane);

  StepContext& step_;
  SessionViewports& viewports_;
  CameraControl& camera_;
  Opening& opening_;
  LinkFollower& links_;
  Picker& picker_;
  FirstViewOptions options_;
};

}  // namespace gs::app
