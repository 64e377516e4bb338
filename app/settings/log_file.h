#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace gs::app {

/// Log on disk with one line per entry and its time. A full log is renamed to `path`.old, replacing the previous one.
/// Several programs may write to the same log. One thread.
class LogFile {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{1} << 20;  // of each of the two files

  /// Creates a log. An empty path disables it.
  explicit LogFile(std::string path = {}) : path_(std::move(path)) {}
  /// Appends an entry. `text` is made printable, so that it stays on one line. Ignores write errors.
  void add(std::string_view text, std::size_t most = kMaxBytes);
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace gs::app
