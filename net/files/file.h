#pragma once

#include "net/base/descriptor.h"
#include "net/files/file_stamp.h"
#include "net/files/guarded_mapping.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::net {

/// Reason why a file could not be read or written. The message names the file.
struct FileError {
  std::string message;
};

/// Writes all bytes. Returns false and sets errno on failure.
bool write_all(int file, std::span<const std::byte> bytes);

/// Checks the first bytes (at most 8 KiB) of a file. Returns why it must not be read, or nullopt.
using CheckFirstBytes = std::function<std::optional<std::string>(std::span<const std::byte> first)>;

/// Bytes of a regular file, read-only. Movable. One owner. Any thread.
///
/// Copies small files. Maps larger ones, so that the system can reclaim their memory. If another program truncates a
/// mapped file, the missing bytes read as zeros; if it writes to the file, the bytes change. `changed` reports both. No
/// change of the file ends the program.
class MappedFile {
 public:
  /// Size from which a file is mapped instead of copied.
  static constexpr std::size_t kMappedSize = std::size_t{1} << 20;

  /// Returns all bytes; empty for an empty file.
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return mapping_.bytes().empty() ? std::span<const std::byte>(copy_) : mapping_.bytes();
  }
  /// Releases the memory of the first `size` bytes, for callers that read a large file once.
  void put_aside(std::size_t size) const { mapping_.put_aside(size); }
  /// Returns a message if the file became shorter or was written to since it was opened. Returns nullopt otherwise, as
  /// far as the clock of the file system can tell. Call it after reading.
  [[nodiscard]] std::optional<std::string> changed() const;

 private:
  friend std::variant<MappedFile, FileError> map_file(const std::string& path, const CheckFirstBytes& check);

  std::vector<std::byte> copy_;
  GuardedMapping mapping_;
  // For mapped files.
  Descriptor file_;
  FileStamp stamp_;
};

/// Opens a regular file (or a link to one) for reading. Refuses folders, pipes, sockets and devices without waiting for
/// them. Calls `check` before it maps a file. Blocks while the disk is read. Any thread.
[[nodiscard]] std::variant<MappedFile, FileError> map_file(const std::string& path, const CheckFirstBytes& check = {});

/// Regular file that is open for reading at any position. Movable. One owner. Several threads may read concurrently. If
/// another program truncates the file, reads return fewer bytes.
class RandomAccessFile {
 public:
  /// Returns the size of the file when it was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Copies the bytes from `offset` on. Returns their number; it is smaller than `to` at the end of the file and after
  /// disk errors. Blocks while the disk is read.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const;

 private:
  friend std::variant<RandomAccessFile, FileError> open_file(const std::string& path);
  RandomAccessFile(Descriptor file, std::uint64_t size) : file_(std::move(file)), size_(size) {}

  Descriptor file_;
  std::uint64_t size_ = 0;
};

/// Opens a regular file (or a link to one). Refuses the same files as map_file().
[[nodiscard]] std::variant<RandomAccessFile, FileError> open_file(const std::string& path);

/// Writes a file completely or not at all: writes a new file in the same folder (unfinished_file.h), which then
/// replaces the old one and, if possible, takes its access rights. Replaces only regular files. Follows a link. After
/// an error, the old file is unchanged and no other file is left. Returns nullopt on success.
[[nodiscard]] std::optional<FileError> write_file_atomically(const std::string& path, std::span<const std::byte> bytes);

}  // namespace gs::net
