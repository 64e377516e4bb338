#pragma once

#include "app/window/window_event.h"

#include <array>
#include <optional>
#include <vector>

namespace gs::app {

/// What is used of libspnav, which speaks with the daemon of 3D mice (spacenavd). Functions as spnav.h declares them.
struct SpnavLibrary {
  /// As spnav.h has it: a union that begins with its type, of eight to ten numbers and a pointer.
  struct Event {
    int type = 0;  // 1: motion, 2: button
    int values[15] = {};
  };
  int (*open)() = nullptr;  // -1: there is no daemon
  int (*close)() = nullptr;
  int (*poll_event)(Event* event) = nullptr;  // 0: there is none
};
/// The library of the system, opened at run time. Nothing: there is none.
[[nodiscard]] std::optional<SpnavLibrary> open_spnav();

/// A 3D mouse: its cap moves and turns, its first two buttons are keys. Without a library or a daemon it is not there,
/// and nobody is told. One thread.
class SpaceMouse {
 public:
  explicit SpaceMouse(std::optional<SpnavLibrary> library);
  SpaceMouse() : SpaceMouse(open_spnav()) {}
  ~SpaceMouse();
  SpaceMouse(const SpaceMouse&) = delete;
  SpaceMouse& operator=(const SpaceMouse&) = delete;

  [[nodiscard]] bool there() const { return open_; }
  /// What has happened since the last call, at `time`.
  [[nodiscard]] std::vector<WindowEvent> take(double time);

 private:
  std::optional<SpnavLibrary> library_;
  bool open_ = false;
};

}  // namespace gs::app
