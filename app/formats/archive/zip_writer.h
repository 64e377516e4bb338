#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Writer of a ZIP archive of uncompressed files. All files have a fixed date, so equal contents give equal bytes.
class ZipWriter {
 public:
  /// Appends a file. The archive must stay below 4 GiB and have fewer than 65,535 files.
  void add(const std::string& name, std::span<const std::byte> bytes);
  /// Returns the bytes of the files so far, without the directory.
  [[nodiscard]] std::size_t size() const { return archive_.size(); }
  /// Returns the archive with its directory. Call once, after all files.
  [[nodiscard]] std::vector<std::byte> take();

 private:
  std::vector<std::byte> archive_, directory_;
  std::size_t files_ = 0;
};

}  // namespace gs::app
