#pragma once

#include "base/noncopyable.h"

#include <chrono>
#include <functional>

namespace gs::app {

// Work for a world on the session's thread. The user can end work that takes long, because the thread cannot handle
// keys meanwhile.

/// Sets the function that reports whether the user has asked to stop work: by Esc, by closing the window or by a
/// signal. The calling thread becomes the session's thread. An empty function removes it. `during_waits` is called
/// before it while programs are awaited.
void set_stop_request(std::function<bool()> is_asked_to_stop, std::function<void()> during_waits = {});

/// Piece of work for one world. Pieces inside of another belong to it. Does nothing on other threads.
class WorldWork : NonCopyable {
 public:
  WorldWork();
  ~WorldWork();
  /// Reports whether is_work_unwanted() has returned true during this piece.
  [[nodiscard]] bool was_stopped() const;

 private:
  bool counts_;
};

/// Reports whether long work should end now. Asks at most 50 times a second, from 0.5 s of work on, and then stays true
/// until the work ends. Always false outside of WorldWork and on other threads. Any thread.
[[nodiscard]] bool is_work_unwanted();

/// Reports whether a wait for programs should end. Asks at most 50 times a second, after 0.1 s of work or since
/// `began`. Always false on threads without a stop request.
[[nodiscard]] bool is_wait_unwanted(std::chrono::steady_clock::time_point began);

}  // namespace gs::app
