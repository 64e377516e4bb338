#pragma once

#include "app/loading/fetch/small_request.h"
#include "base/noncopyable.h"
#include "net/serve/http_server.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Connection of `serve --stdio` to running simulations of its user (docs/insitu.md). Below a file NAME.live, it serves
/// the resources of the server that the file names. It adds the token of the file to changes of parameters. One
/// thread; requests run on other threads.
class LiveRelay : NonCopyable {
 public:
  /// `wake` is called on other threads when content is ready.
  explicit LiveRelay(std::function<void()> wake) : wake_(std::move(wake)) {}
  ~LiveRelay() { stop_ = true; }

  /// Returns a resource of a simulation. Refuses requests of documents that may read more than the simulation, because
  /// a file of another origin could name any server.
  [[nodiscard]] net::HeldContent content(const net::ContentRequest& request);
  /// Changes parameters of a simulation, with a path such as "/home/ann/run/NAME.live/parameters". Does not wait for
  /// the answer of the simulation (PostAnswer::later).
  [[nodiscard]] net::PostAnswer post(const net::PostRequest& request);

 private:
  /// Request on another thread. Its destructor waits until the thread has called `wake_`.
  struct Running {
    std::future<SmallAnswer> coming;
    std::future<void> thread;
  };
  struct Change {
    std::shared_future<SmallAnswer> coming;
    std::future<void> thread;
  };
  struct Pending {
    Running running;
    std::optional<std::string> body;  // nullopt until the answer was received; empty after a failure
    bool gone = false;                // the simulation no longer has the resource
    std::chrono::steady_clock::time_point came{};
    std::chrono::milliseconds kept{};
  };
  void keep_recent();
  [[nodiscard]] Running send(net::Request wanted, std::uint64_t most_bytes = kMostSmallBytes);

  const std::function<void()> wake_;
  const LoadOptions load_;
  std::atomic<bool> stop_{false};
  std::map<std::string, Pending> pending_;  // by path
  std::vector<Change> posts_;               // changes that wait for an answer
};

/// Path of a file of a simulation, and path of a resource below it.
struct LivePath {
  std::string file, resource;  // "/home/ann/run/heat.live", "insitu.json"
};
/// Splits a path such as "home/ann/run/heat.live/insitu.json". Returns nullopt if no folder in the path has
/// the extension kLiveFileEnding.
[[nodiscard]] std::optional<LivePath> live_path(std::string_view path);

}  // namespace gs::app
