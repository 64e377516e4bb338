#include "net/transfer/idle_handles.h"

#include <utility>

namespace gs::net {
namespace {

/// Maximum number of handles that wait for the next transport.
constexpr std::size_t kMostIdleHandles = 4;
/// Maximum number of idle connections of a handle.
constexpr long kIdleConnections = 32;

}  // namespace

MultiHandle new_handle() {
  // curl counts the calls of this function. They are thread-safe since curl 7.84.
  curl().curl_global_init(CURL_GLOBAL_DEFAULT);
  MultiHandle multi(curl().curl_multi_init());
  curl().curl_multi_setopt(multi.get(), CURLMOPT_MAXCONNECTS, kIdleConnections);
  curl().curl_multi_setopt(multi.get(), CURLMOPT_PIPELINING, static_cast<long>(CURLPIPE_MULTIPLEX));
  return multi;
}

MultiHandle IdleHandles::take() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return nullptr;
  MultiHandle newest = std::move(idle_.back());
  idle_.pop_back();
  return newest;
}

void IdleHandles::keep(MultiHandle handle) {
  MultiHandle dropped;  // destroyed after the lock, so that its connections close without it
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(handle));
  if (idle_.size() <= kMostIdleHandles) return;
  dropped = std::move(idle_.front());
  idle_.pop_front();
}

IdleHandles& idle_handles() {
  // Never destroyed, because threads may end after static objects.
  static IdleHandles& handles = *new IdleHandles;
  return handles;
}

}  // namespace gs::net
