#pragma once

#include "net/base/clock.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace gs::net {

enum class MadeState : std::uint8_t { ready, waiting, failed, full };

/// Why something was not made.
struct MakeFailure {
  std::string message;
  bool lasting = true;  // it lies in the source, and would be so again; else in this machine: a full disk, for example
};

/// What has become of a file that is to be made.
struct MadeFile {
  MadeState state = MadeState::waiting;
  std::string path;     // when ready
  MakeFailure failure;  // when failed
};

/// Files that are made of others when someone asks for them, and kept: each is
/// made once, in a lane, which makes one at a time by a thread of its own. What
/// was made stands in a folder, bounded in bytes: what has not been used for
/// longest goes. What failed is tried again after a while. Any thread.
class MadeFiles {
 public:
  /// Writes `out`, in a folder that it has for itself; what went wrong, if it did. Should end soon when stopped. On a
  /// lane's thread.
  using Make = std::function<std::optional<MakeFailure>(const std::string& out, const std::stop_token& stop)>;

  struct Options {
    std::string folder;                                 // there, and ours
    std::uint64_t most_bytes = std::uint64_t{4} << 30;  // in the folder
    std::size_t most_waiting = 64;                      // in a lane
    // So long nothing is tried again that failed, for good or for the time being.
    Instant lasting_failure = std::chrono::minutes(10), passing_failure = std::chrono::seconds(2);
    std::function<Instant()> now = clock_now;
  };
  struct Statistics {
    std::uint64_t made = 0, failed = 0, waiting = 0;
  };

  /// `wake` is called from a lane's thread whenever something was made or
  /// failed.
  MadeFiles(Options options, std::size_t lanes, std::function<void()> wake);
  /// Stops what is being made.
  ~MadeFiles();
  MadeFiles(const MadeFiles&) = delete;
  MadeFiles& operator=(const MadeFiles&) = delete;

  /// The file of this key, which must tell all that it is made of; makes it
  /// when it is not there. `extension` with its point.
  [[nodiscard]] MadeFile request(std::size_t lane, const std::string& key, const std::string& extension, Make make);
  /// The same without making it.
  [[nodiscard]] bool is_waiting(std::size_t lane, const std::string& key) const;
  [[nodiscard]] Statistics statistics(std::size_t lane) const;

 private:
  struct Job {
    std::string key, name, extension;
    Make make;
  };
  struct Failed {
    std::string key;
    MakeFailure failure;
    Instant until{};
  };
  struct Lane {
    std::deque<Job> jobs;         // the first is being made
    std::deque<Failed> failures;  // newest last
    Statistics statistics;
    std::jthread thread;
  };
  void work(std::size_t lane, const std::stop_token& stop);
  [[nodiscard]] std::optional<MakeFailure> make(const Job& job, const std::stop_token& stop);
  void clean();

  const Options options_;
  const std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable_any arrived_;
  std::deque<Lane> lanes_;
  std::mutex cleaning_;
};

}  // namespace gs::net
