#pragma once

#include "base/diagnostic.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Log of the diagnostics of all files of a session, including files that could not be opened. Entries outlive the
/// worlds. When more than kMaxFiles files have entries, those of the oldest file are dropped.
class SessionLog {
 public:
  static constexpr std::size_t kMaxFiles = 256;

  struct File {
    std::string path;
    Diagnostics diagnostics;  // of the last reading of the file
    std::size_t told = 0;     // number of `diagnostics` that take_untold() has returned
  };

  /// Replaces all diagnostics of a file.
  void note(std::string_view path, const Diagnostics& diagnostics);
  /// Returns the files in the order in which they were first read.
  [[nodiscard]] const std::vector<File>& files() const { return files_; }
  [[nodiscard]] std::size_t errors() const;
  [[nodiscard]] std::size_t warnings() const;
  [[nodiscard]] std::size_t entries() const;
  /// Returns the number of diagnostics that were only counted, because too many were reported.
  [[nodiscard]] std::size_t dropped() const;
  /// Returns all diagnostics that no earlier call has returned, one line each.
  [[nodiscard]] std::vector<std::string> take_untold();

 private:
  std::vector<File> files_;
};

}  // namespace gs::app
