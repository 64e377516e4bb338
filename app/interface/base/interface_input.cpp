#include "app/interface/base/interface_input.h"

#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <cstddef>

namespace gs::app {
namespace {

using Kind = WindowEvent::Kind;

constexpr std::size_t kMaxEvents = 10'000;  // max pending events; beyond it, the oldest are dropped
constexpr int kFirstFunctionKey = 256;  // first GLFW key code that is not a character

bool is_modifier(const WindowEvent& event) {
  return event.key == Key::shift || event.key == Key::control || event.key == Key::alt;
}

}  // namespace

void InterfaceInput::add(const std::vector<WindowEvent>& events) {
  for (const WindowEvent& event : events) {
    const bool matters = event.kind != Kind::drop && event.kind != Kind::refresh && event.kind != Kind::axes;
    if (!matters) continue;
    if (events_.size() >= kMaxEvents) events_.pop_front();
    // Replace the last pending pointer movement by the newer one.
    if (event.kind == Kind::pointer && !events_.empty() && events_.back().kind == Kind::pointer) events_.pop_back();
    events_.push_back(event);
  }
}

void InterfaceInput::apply(ImGuiIO& io, bool text_waits) {
  Changes changes;
  while (!events_.empty() && take(events_.front(), io, changes, text_waits)) events_.pop_front();
  for (std::size_t i = 0; i < buttons_.size(); ++i) io.MouseDown[i] = buttons_[i];
  const ImVec2& pixels = io.DisplayFramebufferScale;
  const bool known = pointer_ && pixels.x > 0 && pixels.y > 0;
  io.MousePos = known ? ImVec2(pointer_->x / pixels.x, pointer_->y / pixels.y) : ImVec2(-FLT_MAX, -FLT_MAX);
}

bool InterfaceInput::take(const WindowEvent& event, ImGuiIO& io, Changes& changes, bool text_waits) {
  switch (event.kind) {
    case Kind::key_down:
    case Kind::key_up:
      return take_key(event, io, changes, text_waits);
    case Kind::character:
      if (text_waits || changes.editing) return false;
      changes.character = true;
      io.AddInputCharacter(static_cast<unsigned>(event.code));
      return true;
    case Kind::button_down:
    case Kind::button_up: {
      bool& changed = changes.buttons[static_cast<std::size_t>(event.button)];
      if (changed) return false;
      changed = true;
      buttons_[static_cast<std::size_t>(event.button)] = event.kind == Kind::button_down;
      pointer_ = event.pointer;
      return true;
    }
    case Kind::pointer:
      // Let pointer movements wait for the next frame after a press or release, which belongs to the pointer position
      // at its time.
      if (std::find(changes.buttons.begin(), changes.buttons.end(), true) != changes.buttons.end()) return false;
      pointer_ = event.pointer;
      return true;
    case Kind::pointer_left:
      // Keep the position while a button is held, because a drag continues outside the window.
      if (std::find(buttons_.begin(), buttons_.end(), true) == buttons_.end()) pointer_.reset();
      return true;
    case Kind::wheel:
      io.MouseWheel += event.wheel;
      return true;
    case Kind::focus_lost:
      std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
      io.KeyCtrl = io.KeyShift = io.KeyAlt = false;
      buttons_.fill(false);
      return true;
    case Kind::drop:
    case Kind::refresh:
    case Kind::axes:
      break;
  }
  return true;
}

bool InterfaceInput::take_key(const WindowEvent& event, ImGuiIO& io, Changes& changes, bool text_waits) const {
  if (event.code < 0 || event.code >= IM_ARRAYSIZE(io.KeysDown)) return true;
  const bool down = event.kind == Kind::key_down;
  const bool commands = io.KeyCtrl || io.KeyAlt;
  if (is_modifier(event)) {
    if (changes.modifier || changes.plain || changes.character) return false;
    changes.modifier = true;
  } else {
    const bool typed = event.code < kFirstFunctionKey && !commands;  // a character event follows this key event
    const bool again = std::find(changes.keys.begin(), changes.keys.end(), event.code) != changes.keys.end();
    if ((again || changes.character) && !typed) return false;
    if (text_waits && !typed) return false;
    changes.plain = true;
    changes.editing = changes.editing || (down && !typed);
    changes.keys.push_back(event.code);
  }
  io.KeysDown[event.code] = down;
  if (event.key == Key::control) io.KeyCtrl = down;
  if (event.key == Key::shift) io.KeyShift = down;
  if (event.key == Key::alt) io.KeyAlt = down;
  return true;
}

}  // namespace gs::app
