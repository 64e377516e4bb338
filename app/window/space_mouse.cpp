#include "app/window/space_mouse.h"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

constexpr int kSpnavMotion = 1, kSpnavButton = 2;  // values of Event::type, from spnav.h
constexpr float kFullPush = 350;                   // value at full deflection
constexpr float kRestingHand = 0.08f;  // dead zone; users rarely push the cap along only one axis
constexpr int kMaxSpnavEvents = 256;  // max events per take(), so that a flood cannot block the window
constexpr std::array<Key, 2> kSpnavKeys = {Key::page_up, letter_key('F')};

float axis(int value) {
  const float part = std::clamp(static_cast<float>(value) / kFullPush, -1.0f, 1.0f);
  if (std::abs(part) <= kRestingHand) return 0;
  return std::copysign((std::abs(part) - kRestingHand) / (1 - kRestingHand), part);
}

}  // namespace

std::optional<SpnavLibrary> open_spnav() {
  void* const library = dlopen("libspnav.so.0", RTLD_NOW | RTLD_LOCAL);
  if (!library) return std::nullopt;
  SpnavLibrary result;
  result.open = reinterpret_cast<int (*)()>(dlsym(library, "spnav_open"));
  result.close = reinterpret_cast<int (*)()>(dlsym(library, "spnav_close"));
  result.poll_event = reinterpret_cast<int (*)(SpnavLibrary::Event*)>(dlsym(library, "spnav_poll_event"));
  if (!result.open || !result.close || !result.poll_event) return std::nullopt;
  return result;
}

SpaceMouse::SpaceMouse(std::optional<SpnavLibrary> library)
    : library_(library), open_(library_ && library_->open() != -1) {}

SpaceMouse::~SpaceMouse() {
  if (open_) library_->close();
}

std::vector<WindowEvent> SpaceMouse::take(double time) {
  std::vector<WindowEvent> events;
  if (!open_) return events;
  SpnavLibrary::Event raw;
  for (int i = 0; i < kMaxSpnavEvents && library_->poll_event(&raw) != 0; ++i) {
    WindowEvent event;
    event.time = time;
    if (raw.type == kSpnavMotion) {
      // x points to the right, y upwards, z to the user or, with some daemons, away. Rotations are about the same axes.
      event.kind = WindowEvent::Kind::axes;
      event.device = AxisDevice::space_mouse;
      event.move = {axis(raw.values[0]), axis(raw.values[1]), axis(raw.values[2])};
      event.turn = {-axis(raw.values[4]), axis(raw.values[3])};
      // Replace the previous position of the cap, because only the latest one matters.
      if (!events.empty() && events.back().kind == WindowEvent::Kind::axes) events.pop_back();
    } else if (raw.type == kSpnavButton && raw.values[1] >= 0 && raw.values[1] < static_cast<int>(kSpnavKeys.size())) {
      event.kind = raw.values[0] != 0 ? WindowEvent::Kind::key_down : WindowEvent::Kind::key_up;
      event.key = kSpnavKeys[static_cast<std::size_t>(raw.values[1])];
    } else {
      continue;
    }
    events.push_back(event);
  }
  return events;
}

}  // namespace gs::app
