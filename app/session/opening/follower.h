#pragma once

#include "app/loading/fetch/load_options.h"
#include "app/session/documents/series.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "base/noncopyable.h"

#include <atomic>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace gs::app {

/// Returns a text that identifies the version of a file, a folder, a series of numbered files, or a URL. Returns an
/// empty text on failure. Blocks on disks and servers until `stop` is true. Any thread.
[[nodiscard]] std::string version_of(const std::string& path, const LoadOptions& load, const std::atomic<bool>& stop);

/// Files that grow while the session shows them, such as the output of a running simulation. Polls their versions on
/// other threads, more rarely while nothing changes, and reloads changed files. One thread; none in simulated time.
class Follower : NonCopyable {
 public:
  static constexpr double kLeastWait = 0.5, kMostWait = 10, kLeastWaitForServers = 2, kMostWaitForServers = 30;
  static constexpr double kLeastWaitForLive = 0.1;
  static constexpr double kMostWaitForLive = 2;  // for worlds of a running simulation, which are always followed

  /// Other threads call `wake`, which must be thread-safe.
  Follower(StepContext& step, SessionViewports& viewports, SeriesList& series, const LoadOptions& load,
           std::function<void()> wake);
  ~Follower();

  /// Starts or stops following a file.
  void follow(const std::string& path, bool on);
  [[nodiscard]] bool follows(const std::string& path) const;
  /// Sets whether the newest step is shown. Panels call it when the user chooses another step.
  void follow_newest(const std::string& path, bool on);
  [[nodiscard]] bool shows_newest(const std::string& path) const;

  /// Starts due checks, and reads changed files again.
  void check();
  /// Returns the time of the next check; nullopt if nothing visible is followed.
  [[nodiscard]] std::optional<double> next_due() const;
  /// Notes that a file could not be read. Returns true if it is followed; then it is read again after a while.
  [[nodiscard]] bool note_failed(const std::string& path);

 private:
  struct File {
    bool on = true, newest = true, changed = false;
    std::string version;
    double wait = kLeastWait, due = 0;     // seconds between checks; time of the next one
    double pause = kLeastWait, again = 0;  // seconds after a failed reading; time from which it is read again
    std::future<std::string> coming;
  };
  [[nodiscard]] std::vector<std::string> visible() const;
  [[nodiscard]] bool is_live(const std::string& path) const;
  [[nodiscard]] double least_wait(const std::string& path) const;
  [[nodiscard]] double most_wait(const std::string& path) const;
  void reload(const std::string& path, File& file);

  StepContext& step_;
  SessionViewports& viewports_;
  SeriesList& series_;
  const LoadOptions& load_;
  std::function<void()> wake_;
  std::atomic<bool> stop_{false};
  std::map<std::string, File> files_;  // by entry
};

}  // namespace gs::app
