#pragma once

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

/// Reason why a file was not made.
struct MakeFailure {
  std::string message;
  bool lasting = true;  // caused by the source, so retrying is useless; otherwise by this machine, such as a full disk
};

/// State of a file that is to be made.
struct MadeFile {
  MadeState state = MadeState::waiting;
  std::string path;     // if ready
  MakeFailure failure;  // if failed
};

/// Files that are made from others on demand, and kept. Each is made once, in a lane. A lane makes one file at a time,
/// but passes over slow ones: after `patience` the next file begins on another thread of the lane. The folder of made
/// files is bounded in bytes; the file that was unused for longest is removed first. Failed files are retried after a
/// while. Any thread.
class MadeFiles {
 public:
  /// Writes `out` in its own folder. Returns the error, or nullopt. Should end soon when stopped. Runs on a thread of
  /// the lane.
  using Make = std::function<std::optional<MakeFailure>(const std::string& out, const std::stop_token& stop)>;

  struct Options {
    std::string folder;                                 // must exist and be used by nothing else
    std::uint64_t most_bytes = std::uint64_t{4} << 30;  // maximum bytes in the folder
    std::size_t most_waiting = 64;                      // maximum waiting files per lane
    // Delays before failed files are retried, for lasting and for temporary failures.
    Instant lasting_failure = std::chrono::minutes(10), passing_failure = std::chrono::seconds(2);
    Instant patience = std::chrono::milliseconds(500);  // a file that takes longer is slow
    std::function<Instant()> now = clock_now;
  };
  struct Statistics {
    std::uint64_t made = 0, failed = 0, waiting = 0;
  };

  /// `at_once` holds the number of threads of each lane. A lane's thread calls `wake` whenever a file was made or
  /// failed.
  MadeFiles(Options options, const std::vector<std::size_t>& at_once, std::function<void()> wake);
  /// Stops the jobs that run.
  ~MadeFiles();
  MadeFiles(const MadeFiles&) = delete;
  MadeFiles& operator=(const MadeFiles&) = delete;

  /// Returns the file of a key, and makes it if it is missing. The key must identify all inputs. `extension` includes
  /// its dot.
  [[nodiscard]] MadeFile request(std::size_t lane, const std::string& key, const std::string& extension, Make make);
  /// Reports whether the file of a key is waiting or being made.
  [[nodiscard]] bool is_waiting(std::size_t lane, const std::string& key) const;
  [[nodiscard]] Statistics statistics(std::size_t lane) const;

 private:
  struct Job {
    std::string key, name, extension;
    Make make;
    std::optional<Instant> begun;  // empty while it waits for a thread
  };
  struct Failed {
    std::string key;
    MakeFailure failure;
    Instant until{};
  };
  struct Lane {
    std::list<Job> jobs;          // in the order of the requests
    std::deque<Failed> failures;  // newest last
    Statistics statistics;
    std::vector<std::jthread> threads;
  };
  void work(Lane& lane, const std::stop_token& stop);
  /// Waits for a job that may begin. Returns the end of the list when stopped.
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
