#include "app/session/session.h"
#include "app/view/navigation.h"

#include <string>

// Sounds of the worlds of a session (VRML97 6.42).
namespace gs::app {

void Session::listen(Document& document, const View& leader) {
  if (!leader.list || document.world.media.empty()) return;
  sounds_.add(*leader.list, document.runtime->execution(), document.world.media,
              world_from_viewer(leader.navigation.pose));
}

void Session::change_sound(Action action) {
  if (action == Action::mute)
    sounds_.set_muted(!sounds_.muted());
  else
    sounds_.change_volume(action == Action::louder ? 1 : -1);
  std::string text = sounds_.muted() ? "Sound off" : "Sound on";
  if (!sounds_.muted() && sounds_.volume() < 0) text += ", " + std::to_string(sounds_.volume()) + " dB";
  if (device_ && device_->state() == SoundDevice::State::silent) text += "; this system has no sound device";
  tell(text, false);
}

}  // namespace gs::app
