#pragma once

#include "base/noncopyable.h"
#include "net/limits/clock.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace gs::net {

enum class MadeState : std::uint8_t { ready, waiting, failed, full };

/// Reason why a file cannot be made.
struct MakeFailure {
  std::string message;
  bool lasting = true;  // the source is the cause, so a retry is useless; otherwise temporary, such as a full disk
};

/// State of a made file.
struct MadeFile {
  MadeState state = MadeState::waiting;
  std::string path;  // path of the file, if ready
  MakeFailure failure;  // reason, if failed
};

/// Files that are made from other files on demand, and cached. A lane makes one file at a time. If a file takes longer
/// than `patience`, the lane begins the next file on another thread.
///
/// The folder is bounded in bytes: the file that was unused for the longest time is removed first. A failed file is
/// made again after a delay. Any thread.
class MadeFiles : NonCopyable {
 public:
  /// Writes the file `out`, which has its own folder. Returns the error, or nullopt. Should end soon after a stop
  /// request. Runs on a thread of the lane.
  using Make = std::function<std::optional<MakeFailure>(const std::string& out, const std::stop_token& stop)>;

  struct Options {
    std::string folder;  // folder of the made files; must exist and contain nothing else
    std::uint64_t most_bytes = std::uint64_t{4} << 30;  // maximum bytes in the folder
    std::size_t most_waiting = 64;  // maximum waiting jobs per lane
    // Delays before a failed file is made again: after lasting and after temporary failures.
    Instant lasting_failure = std::chrono::minutes(10), passing_failure = std::chrono::seconds(2);
    Instant patience = std::chrono::milliseconds(500);  // a job that takes longer is slow
    std::function<Instant()> now = clock_now;
  };
  struct Statistics {
    std::uint64_t made = 0, failed = 0, waiting = 0;
  };

  /// Creates lanes. `at_once` holds the number of threads per lane. A lane's thread calls `wake` when a file is made or
  /// has failed.
  MadeFiles(Options options, const std::vector<std::size_t>& at_once, std::function<void()> wake);
  /// Stops the running jobs and waits for them.
  ~MadeFiles();

  /// Returns the state of the file for a key. Starts to make the file if it is missing. The key must identify all
  /// inputs. `extension` includes its dot.
  [[nodiscard]] MadeFile request(std::size_t lane, const std::string& key, const std::string& extension, Make make);
  /// Reports whether the file for a key waits or is being made.
  [[nodiscard]] bool is_waiting(std::size_t lane, const std::string& key) const;
  [[nodiscard]] Statistics statistics(std::size_t lane) const;

 private:
  struct Job {
    std::string key, name, extension;
    Make make;
    std::optional<Instant> begun;  // nullopt while the job waits for a thread
  };
  struct Failed {
    std::string key;
    MakeFailure failure;
    Instant until{};
  };
  struct Lane {
    std::list<Job> jobs;  // waiting and running jobs, in the order of the requests
    std::deque<Failed> failures;  // recent failures, newest last
    Statistics statistics;
    std::vector<std::jthread> threads;
  };
  void work(Lane& lane, const std::stop_token& stop);
  /// Waits for a job that may begin. Returns the end of the list after a stop request.
  [[nodiscard]] std::list<Job>::iterator begin_next(Lane& lane, std::unique_lock<std::mutex>& lock,
                                                    const std::stop_token& stop);
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
