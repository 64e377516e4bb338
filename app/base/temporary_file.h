#pragma once

#include "base/noncopyable.h"
#include "net/files/temporary_folder.h"

#include <cstddef>
#include <span>
#include <string>

namespace gs::app {

/// Temporary file. Removed when this object is destroyed.
class TemporaryFile : NonCopyable {
 public:
  /// Creates a file. Its name ends in `name`, because the extension may identify the type. Replaces unusual characters
  /// by '_'.
  TemporaryFile(const std::string& name, std::span<const std::byte> bytes);
  ~TemporaryFile();

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Returns the reason why the file could not be created. Empty on success.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  net::LockedFolder folder_;
  std::string path_, problem_;
};

/// Removes the temporary files of all objects, before a process ends without calling destructors. Any thread.
void remove_temporary_files();

/// Removes temporary folders that killed processes have left behind. Call once, at the start.
void remove_abandoned_files();

/// Removes unfinished files (net/files/unfinished_file.h) that killed processes have left in the folder of `file`. Does
/// nothing if `file` is empty.
void remove_unfinished_beside(const std::string& file);

}  // namespace gs::app
