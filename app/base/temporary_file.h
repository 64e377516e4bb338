#pragma once

#include "net/files/temporary_folder.h"

#include <cstddef>
#include <span>
#include <string>

namespace gs::app {

/// Temporary file that is removed with this object.
class TemporaryFile {
 public:
  /// Creates a file. Its name ends in `name`, so that the extension gives its type. Only plain letters of `name` are
  /// kept.
  TemporaryFile(const std::string& name, std::span<const std::byte> bytes);

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Returns the reason why there is no file; empty on success.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  net::LockedFolder folder_;
  std::string path_, problem_;
};

/// Removes the temporary folders of killed processes. Call once, at the start.
void remove_abandoned_files();

/// Removes the unfinished files (net/files/unfinished_file.h) of killed processes in the folder of `file`. Does nothing
/// if `file` is empty.
void remove_unfinished_beside(const std::string& file);

}  // namespace gs::app
