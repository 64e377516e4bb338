#pragma once

#include "net/base/descriptor.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>

namespace gs::net {

struct FileError;

/// File without a name for data that exceed memory. It disappears when it is closed, even if the process is killed.
/// Movable. One thread writes; then several may read.
class TemporaryFile {
 public:
  /// Creates a file in `folder`, or in $TMPDIR or /tmp if that is empty. Returns an error on failure.
  [[nodiscard]] static std::variant<TemporaryFile, FileError> create(const std::string& folder);

  /// Adds bytes at the end. Returns false if the disk is full, or on other errors; problem() has the reason.
  [[nodiscard]] bool append(std::span<const std::byte> bytes);
  /// Returns the number of bytes.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Copies bytes from `offset` on. Returns false if there are fewer, or on disk errors.
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const;
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  TemporaryFile(Descriptor file, std::string folder) : file_(std::move(file)), folder_(std::move(folder)) {}

  Descriptor file_;
  std::string folder_, problem_;
  std::uint64_t size_ = 0;
};

}  // namespace gs::net
