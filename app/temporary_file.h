#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace gs::app {

/// A file in the system's folder for such, which goes when this does.
class TemporaryFile {
 public:
  /// Its name ends in `name`, whose extension may tell its type; of that only plain letters are kept.
  TemporaryFile(const std::string& name, std::span<const std::byte> bytes);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Why there is none; empty: there is.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::string folder_, path_, problem_;
};

}  // namespace gs::app
