#pragma once

#include "vrml/scene/diagnostic.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// What was said of the files of a session, those that could not be opened among them. Nothing leaves it but the oldest
/// of very many files: it outlives what is shown.
class SessionLog {
 public:
  static constexpr std::size_t kMostFiles = 256;

  struct File {
    std::string path;
    vrml::Diagnostics diagnostics;  // of the newest reading
    std::size_t told = 0;           // of these, that `take_untold` has given
  };

  /// All that is said of a file by now, in the place of what was said before.
  void note(std::string_view path, const vrml::Diagnostics& diagnostics);
  /// In the order in which they were first read.
  [[nodiscard]] const std::vector<File>& files() const { return files_; }
  [[nodiscard]] std::size_t errors() const;
  [[nodiscard]] std::size_t warnings() const;
  [[nodiscard]] std::size_t entries() const;
  /// How many were counted and not kept.
  [[nodiscard]] std::size_t dropped() const;
  /// What nobody was told of yet, a line each.
  [[nodiscard]] std::vector<std::string> take_untold();

 private:
  std::vector<File> files_;
};

}  // namespace gs::app
