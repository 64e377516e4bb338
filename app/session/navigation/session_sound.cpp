#include "app/session/navigation/session_sound.h"

#include "app/view/navigation.h"

#include <string>

namespace gs::app {

SessionSound::SessionSound(StepContext& step, bool audible, bool muted) : step_(step) {
  stage_.set_muted(muted);
  if (audible) device_ = std::make_unique<SoundDevice>(stage_.mixer(), world_time);
}

void SessionSound::add(Document& document, const View& leader) {
  if (!leader.list || document.world.media.empty()) return;
  stage_.add(*leader.list, document.runtime->execution(), document.world.media,
             world_from_viewer(leader.navigation.pose));
}

void SessionSound::end() {
  stage_.end(step_.now);
  if (device_) device_->wake();
}

bool SessionSound::run(Action action) {
  if (action == Action::mute)
    stage_.set_muted(!stage_.muted());
  else if (action == Action::louder || action == Action::softer)
    stage_.change_volume(action == Action::louder ? 1 : -1);
  else
    return false;
  std::string text = stage_.muted() ? "Sound off" : "Sound on";
  if (!stage_.muted() && stage_.volume() < 0) text += ", " + std::to_string(stage_.volume()) + " dB";
  if (device_ && device_->state() == SoundDevice::State::silent) text += "; this system has no sound device";
  step_.notify(text, false);
  return true;
}

}  // namespace gs::app
