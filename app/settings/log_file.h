#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace gs::app {

/// Log on disk. Each entry is one line with its time. A full log is renamed to `path`.old and replaces the previous
/// file of that name. Several programs may write to the same log. One thread.
class LogFile {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{1} << 20;  // max bytes of the log, and of the old log

  /// Prepares a log; add() creates the file. With an empty path, add() does nothing.
  explicit LogFile(std::string path = {}) : path_(std::move(path)) {}
  /// Appends an entry to the log. Replaces unprintable characters, so that `text` stays on one line. Begins a new log
  /// if the present one has `most` bytes. Ignores errors of writing.
  void add(std::string_view text, std::size_t most = kMaxBytes);
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace gs::app
