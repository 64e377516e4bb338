#include "app/view/input_tracker.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr double kDoubleClickTime = 0.4;  // max seconds between two presses
constexpr float kDoubleClickRange = 6;  // max pixels between two presses
constexpr float kPixelsANotch = 20;  // pixels of a zoom drag that equal one wheel notch

DragButton drag_button(MouseButton button) {
  return button == MouseButton::left    ? DragButton::left
         : button == MouseButton::right ? DragButton::right
                                        : DragButton::middle;
}

}  // namespace

InputTracker::Gesture InputTracker::take(const WindowEvent& event, NavigationMode mode) {
  Gesture gesture;
  using Kind = WindowEvent::Kind;
  switch (event.kind) {
    case Kind::key_down:
      keys_.insert(event.key);
      break;
    case Kind::key_up:
      keys_.erase(event.key);
      break;
    case Kind::focus_lost:
      release();
      break;
    case Kind::wheel:
      wheel_ += event.wheel;
      pointer_ = event.pointer;
      gesture.needs_target = true;
      break;
    case Kind::pointer:
      if (drag_ != Drag::none) {
        moved_ += event.pointer - pointer_;
        moved_drag_ = drag_;
      }
      pointer_ = event.pointer;
      break;
    case Kind::button_down:
      pointer_ = event.pointer;
      if (drag_ != Drag::none) break;  // a further button does not change a drag that has begun
      drag_ = drag_of(mode, drag_button(event.button), event.shift || event.control);
      button_ = event.button;
      press_ = event.pointer;
      target_.reset();
      gesture.needs_target = drag_ == Drag::pan || drag_ == Drag::zoom;
      gesture.turns = drag_ == Drag::rotate;
      if (event.button == MouseButton::left) {
        gesture.double_click = last_click_ >= 0 && event.time - last_click_ < kDoubleClickTime &&
                               glm::distance(event.pointer, last_click_place_) < kDoubleClickRange;
        last_click_ = gesture.double_click ? -1 : event.time;
        last_click_place_ = event.pointer;
      }
      break;
    case Kind::button_up:
      if (event.button != button_) break;
      gesture.click = drag_ != Drag::none && event.button == MouseButton::left &&
                      glm::distance(event.pointer, press_) < kDoubleClickRange;
      drag_ = Drag::none;
      break;
    case Kind::axes:
      axes_[static_cast<std::size_t>(event.device)] = {event.move, event.turn};
      break;
    case Kind::drop:
    case Kind::pointer_left:
    case Kind::character:
    case Kind::refresh:
      break;
  }
  return gesture;
}

float InputTracker::axis(Key negative, Key positive) const {
  return (down(positive) ? 1.0f : 0.0f) - (down(negative) ? 1.0f : 0.0f);
}

NavigationInput InputTracker::input(NavigationMode mode, const Viewport& viewport) {
  NavigationInput input;
  input.viewport = viewport.size();
  input.zoom = std::exchange(wheel_, 0.0f);
  input.target = target_;
  input.fast = down(Key::shift);
  const glm::vec2 moved = std::exchange(moved_, glm::vec2(0));
  const Drag moved_drag = std::exchange(moved_drag_, Drag::none);
  if (drag_ == Drag::travel) {
    input.drag = drag_;
    input.from_press = pointer_ - press_;
  } else if (moved_drag != Drag::none && moved_drag != Drag::travel) {
    input.drag = moved_drag;
    input.moved = moved;
    if (moved_drag == Drag::zoom) input.zoom -= moved.y / kPixelsANotch;
  }
  if (down(Key::control) || down(Key::alt)) return input;
  input.move = {axis(letter_key('A'), letter_key('D')), axis(letter_key('Q'), letter_key('E')),
                axis(letter_key('S'), letter_key('W'))};
  input.turn = {axis(Key::left, Key::right), 0};
  const float up = axis(Key::down, Key::up);
  if (mode == NavigationMode::fly || mode == NavigationMode::walk)
    input.move.z += up;
  else
    input.turn.y = up;
  for (const Axes& device : axes_) {
    input.move += device.move;
    input.turn += device.turn;
  }
  input.move = glm::clamp(input.move, glm::vec3(-1), glm::vec3(1));
  input.turn = glm::clamp(input.turn, glm::vec2(-1), glm::vec2(1));
  return input;
}

void InputTracker::release() {
  keys_.clear();
  axes_ = {};
  drag_ = moved_drag_ = Drag::none;
  moved_ = glm::vec2(0);
  wheel_ = 0;
}

bool InputTracker::holding() const {
  if (drag_ == Drag::travel) return true;
  for (const Axes& device : axes_)
    if (device.move != glm::vec3(0) || device.turn != glm::vec2(0)) return true;
  static constexpr Key kHeld[] = {Key::left,       Key::right,      Key::up,         Key::down,       letter_key('W'),
                                  letter_key('A'), letter_key('S'), letter_key('D'), letter_key('Q'), letter_key('E')};
  return std::any_of(std::begin(kHeld), std::end(kHeld), [&](Key key) { return down(key); });
}

std::optional<glm::vec2> InputTracker::travel_anchor() const {
  return drag_ == Drag::travel ? std::optional(press_) : std::nullopt;
}

}  // namespace gs::app
