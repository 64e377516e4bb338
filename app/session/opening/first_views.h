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

/// Options for the first view of a file.
struct FirstViewOptions {
  std::string viewpoint;  // initial Viewpoint: its description, DEF name or number
  std::optional<bool> headlight;  // overrides the NavigationInfo of worlds
  std::optional<Pose> camera;  // initial camera, only for the first file
};

/// Creation of the first views of files. One thread.
class FirstViews {
 public:
  FirstViews(StepContext& step, SessionViewports& viewports, CameraControl& camera, Opening& opening,
             LinkFollower& links, Picker& picker, FirstViewOptions options);

  /// Shows files in the viewports that wait for them, after they have been read. Moves each viewer to the Viewpoint of
  /// the link that led to the file.
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
