#pragma once

#include "app/window/window_event.h"
#include "base/noncopyable.h"

#include <array>
#include <optional>
#include <vector>

namespace gs::app {

/// Functions of libspnav that this program uses, declared as in spnav.h. The library connects to spacenavd, the daemon
/// for 3D mice.
struct SpnavLibrary {
  /// Event with the layout of spnav.h. There it is a union that begins with the type and contains eight to ten numbers
  /// and a pointer.
  struct Event {
    int type = 0;  // 1 is a motion, 2 a button
    int values[15] = {};
  };
  int (*open)() = nullptr;  // returns -1 if there is no daemon
  int (*close)() = nullptr;
  int (*poll_event)(Event* event) = nullptr;  // returns 0 if there is no event
};
/// Loads the library of the system. Returns nullopt if it is missing.
[[nodiscard]] std::optional<SpnavLibrary> open_spnav();

/// 3D mouse. The cap moves and turns the viewer; the first two buttons act as keys. Without the library or the daemon,
/// it produces no events and no message. One thread.
class SpaceMouse : NonCopyable {
 public:
  explicit SpaceMouse(std::optional<SpnavLibrary> library);
  SpaceMouse() : SpaceMouse(open_spnav()) {}
  ~SpaceMouse();

  [[nodiscard]] bool there() const { return open_; }
  /// Returns the events since the previous call. `time` is their time in seconds.
  [[nodiscard]] std::vector<WindowEvent> take(double time);

 private:
  std::optional<SpnavLibrary> library_;
  bool open_ = false;
};

}  // namespace gs::app
