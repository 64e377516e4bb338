#pragma once

#include "net/http/curl_library.h"

#include <deque>
#include <memory>
#include <mutex>

namespace gs::net {

using MultiHandle = std::unique_ptr<CURLM, FreeMulti>;

/// Returns a handle without connections.
[[nodiscard]] MultiHandle new_handle();

/// Multi handles of ended transports. They keep idle connections for the next transport. For example, each version of a
/// followed world has its own loader. Each request on a connection checks the address. Any thread.
class IdleHandles {
 public:
  /// Returns the newest handle, or null if there is none.
  [[nodiscard]] MultiHandle take();
  /// Keeps a handle without transfers. Drops the oldest one if there are too many.
  void keep(MultiHandle handle);

 private:
  std::mutex mutex_;
  std::deque<MultiHandle> idle_;  // newest last
};

/// Returns the idle handles of this program.
[[nodiscard]] IdleHandles& idle_handles();

}  // namespace gs::net
