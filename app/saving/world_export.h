#pragma once

#include "app/base/temporary_file.h"

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace gs::app {

/// Input of an export: a file, or a text that was written for it.
struct ExportSource {
  std::string path;
  std::string folder;                     // folder that the text may refer to; empty if `path` is the world's own file
  std::unique_ptr<TemporaryFile> text;    // owner of the text at `path`; null if `path` is the world's own file
  std::vector<std::string> options = {};  // further options of the command
};

/// Export of a world to another format by a child process, so that the window stays responsive. The process runs
/// `export`, or `encode` for a stream. Replaces the target completely or not at all. Destroying this object kills the
/// process. One thread.
class WorldExport {
 public:
  /// Starts the export. Another thread calls `wake` when take() has the result. `program` is GhostSpace.
  WorldExport(ExportSource source, std::string target, std::function<void()> wake,
              std::string program = "/proc/self/exe");

  /// Result of an export.
  struct Result {
    std::string target;
    std::optional<std::string> problem;
  };
  /// Returns the result; nullopt before the export ends.
  [[nodiscard]] std::optional<Result> take();

 private:
  void run(const std::stop_token& stop);

  ExportSource source_;
  std::string target_;
  std::function<void()> wake_;
  std::string program_;
  std::mutex mutex_;
  std::optional<Result> result_;  // guarded by the mutex
  std::jthread thread_;           // last member: its thread uses the others
};

}  // namespace gs::app
