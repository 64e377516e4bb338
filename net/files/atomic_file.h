#pragma once

#include "net/files/file.h"
#include "net/files/unfinished_file.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include <sys/types.h>

namespace gs::net {

/// File that is written in pieces, completely or not at all. The bytes go to an unfinished file (unfinished_file.h) in
/// the same folder, which then replaces the file. Keeps the access rights of the old file if possible. Follows a link.
/// Replaces only regular files. Without commit(), the old file is unchanged and no other file remains. Movable.
class AtomicFile {
 public:
  /// Begins a new version of the file `path`. Returns an error if it cannot be written.
  [[nodiscard]] static std::variant<AtomicFile, FileError> begin(const std::string& path);
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Writes the next bytes. After an error, it writes nothing more, and commit() reports the first error.
  bool write(std::span<const std::byte> bytes);
  /// Replaces bytes at the start, all of which were written before. Otherwise like write().
  bool rewrite_front(std::span<const std::byte> bytes);
  /// Replaces the file. Returns nullopt on success.
  [[nodiscard]] std::optional<FileError> commit();
  /// Returns the first error of write(), or nullopt.
  [[nodiscard]] const std::optional<FileError>& problem() const { return problem_; }
  /// Returns the folder of the file, with a slash at the end.
  [[nodiscard]] const std::string& folder() const { return folder_; }

 private:
  AtomicFile() = default;

  std::string path_, target_, folder_;  // as given, without links, and its folder with a slash at the end
  std::optional<mode_t> mode_;          // of the old file
  UnfinishedFile unfinished_;
  bool done_ = false;
  std::optional<FileError> problem_;
};

}  // namespace gs::net
