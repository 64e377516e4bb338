#pragma once

#include "net/base/descriptor.h"

#include <cstdint>

#include <sys/eventfd.h>
#include <unistd.h>

namespace gs::net {

/// Descriptor that wakes a thread that waits for sockets. ring() makes it readable, on any thread.
class EventFd {
 public:
  EventFd() : event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

  void ring() const {
    const std::uint64_t one = 1;
    if (event_) (void)!::write(event_.get(), &one, sizeof one);
  }
  void still() const {
    std::uint64_t count = 0;
    if (event_) (void)!::read(event_.get(), &count, sizeof count);
  }
  /// Returns the descriptor. It is negative if the system had no free descriptor.
  [[nodiscard]] int descriptor() const { return event_.get(); }

 private:
  Descriptor event_;
};

}  // namespace gs::net
