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
  /// With `audible`, plays the sounds on the system's device. With `muted`, waits until the user turns the sound on.
  SessionSound(StepContext& step, bool audible, bool muted);

  /// Starts the sounds of a step. Call `add` for each visible world, then `end`.
  void begin() { stage_.begin(); }
  /// Adds the sounds of a world. `leader` is the view of its viewer.
  void add(Document& document, const View& leader);
  void end();
  /// Turns the sound on or off, or changes the volume. Returns false for all other actions.
  bool run(Action action);

  [[nodiscard]] SoundStage& stage() { return stage_; }

 private:
  StepContext& step_;
  SoundStage stage_;
  std::unique_ptr<SoundDevice> device_;  // null while the sound is off; declared after stage_, which it plays
};

}  // namespace gs::app
