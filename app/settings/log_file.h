#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace gs::app {

/// A log on disk: a line an entry, with its time. Bounded: when it is full it becomes `path`.old, in the place of the
/// one before, and begins anew. Several programs may write to the same one. One thread.
class LogFile {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 20;  // of each of the two

  /// Empty: nothing is written.
  explicit LogFile(std::string path = {}) : path_(std::move(path)) {}
  /// `text` is made printable, so that it stays a line. Who cannot write is silent: nothing else depends on it.
  void add(std::string_view text, std::size_t most = kMostBytes);
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace gs::app
