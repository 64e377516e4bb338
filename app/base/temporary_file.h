#pragma once

#include "net/files/temporary_folder.h"

#include <cstddef>
#include <span>
#include <string>

namespace gs::app {

/// A file in the system's folder for such, which goes when this does.
class TemporaryFile {
 public:
  /// Its name ends in `name`, whose extension may tell its type; of that only plain letters are kept.
  TemporaryFile(const std::string& name, std::span<const std::byte> bytes);

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Why there is none; empty: there is.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  net::LockedFolder folder_;
  std::string path_, problem_;
};

/// Removes the temporary folders that killed processes left. Call it once, at the start.
void remove_abandoned_files();

/// Removes the unfinished files (net/files/unfinished_file.h) that killed processes left in the folder of `file`. Does
/// nothing if `file` is empty.
void remove_unfinished_beside(const std::string& file);

}  // namespace gs::app
