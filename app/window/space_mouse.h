#pragma once

#include "app/window/window_event.h"

#include <array>
#include <optional>
#include <vector>

namespace gs::app {

/// Functions of libspnav in use, declared as in spnav.h. The library talks to spacenavd, the daemon for 3D mice.
struct SpnavLibrary {
  /// Layout of spnav.h: a union that begins with its type, of eight to ten numbers and a pointer.
  struct Event {
    int type = 0;  // 1: motion, 2: button
    int values[15] = {};
  };
  int (*open)() = nullptr;  // -1 means no daemon
  int (*close)() = nullptr;
  int (*poll_event)(Event* event) = nullptr;  // 0 means no event
};
/// Opens the system's library at run time. Returns nullopt if it is missing.
[[nodiscard]] std::optional<SpnavLibrary> open_spnav();

/// 3D mouse: the cap moves and turns, the first two buttons are keys. Absent without a message if there is no library
/// or daemon. Use from one thread.
class SpaceMouse {
 public:
  explicit SpaceMouse(std::optional<SpnavLibrary> library);
  SpaceMouse() : SpaceMouse(open_spnav()) {}
  ~SpaceMouse();
  SpaceMouse(const SpaceMouse&) = delete;
  SpaceMouse& operator=(const SpaceMouse&) = delete;

  [[nodiscard]] bool there() const { return open_; }
  /// Returns the events since the last call, at `time`.
  [[nodiscard]] std::vector<WindowEvent> take(double time);

 private:
  std::optional<SpnavLibrary> library_;
  bool open_ = false;
};

}  // namespace gs::app
