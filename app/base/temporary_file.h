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

/// Removes what earlier runs left that could not clean up behind themselves. Once, at the start.
void remove_abandoned_files();

}  // namespace gs::app
