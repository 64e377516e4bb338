#pragma once

#include "app/media/sound_device.h"
#include "app/media/sound_stage.h"
#include "app/session/viewports/step.h"
#include "app/session/viewports/view.h"
#include "app/view/actions.h"

#include <memory>

namespace gs::app {

/// Sounds of the visible worlds, each at the position of its viewer (VRML97 6.42). One thread.
class SessionSound {
 public:
  /// If `audible`, plays the sounds on the system's device. If `muted`, there is no sound until the user turns it on.
  SessionSound(StepContext& step, bool audible, bool muted);

  /// Begins the sounds of a step. Then call add() for each visible world, and end().
  void begin() { stage_.begin(); }
  /// Adds the sounds of one world. The camera of `leader` is the position of the viewer.
  void add(Document& document, const View& leader);
  void end();
  /// Runs an action that turns the sound on or off, or changes the volume. Returns false for other actions.
  bool run(Action action);

  [[nodiscard]] SoundStage& stage() { return stage_; }

 private:
  StepContext& step_;
  SoundStage stage_;
  std::unique_ptr<SoundDevice> device_;  // null while the sound is off; declared after stage_, because it plays stage_
};

}  // namespace gs::app
