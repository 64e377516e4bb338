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

/// Reason why a file cannot be read or written. The message names the file.
struct FileError {
  std::string message;
};

/// Writes all bytes to the descriptor `file`. Returns false and sets errno on failure.
bool write_all(int file, std::span<const std::byte> bytes);

/// Check of the first bytes of a file (at most 8 KiB). Returns the reason to refuse the file, or nullopt.
using CheckFirstBytes = std::function<std::optional<std::string>(std::span<const std::byte> first)>;

/// Bytes of a regular file, read-only. Movable. One owner. Any thread.
///
/// Small files are copied. Larger files are mapped, so that the system can reclaim their memory. If another program
/// truncates a mapped file, the missing bytes read as zeros. If it writes to the file, the bytes change. `changed`
/// reports both. No change of the file ends this program.
class MappedFile {
 public:
  /// Size in bytes from which files are mapped instead of copied.
  static constexpr std::size_t kMappedSize = std::size_t{1} << 20;

  /// Returns all bytes of the file.
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return mapping_.bytes().empty() ? std::span<const std::byte>(copy_) : mapping_.bytes();
  }
  /// Returns the descriptor of a mapped file, or -1 for a copied one. It stays open as long as this object.
  [[nodiscard]] int descriptor() const { return mapping_.bytes().empty() ? -1 : file_.get(); }
  /// Releases the memory of the first `size` bytes. For callers that read a large file once.
  void put_aside(std::size_t size) const { mapping_.put_aside(size); }
  /// Returns a message if the file became shorter or was written to after it was opened. Returns nullopt otherwise.
  /// Depends on the clock of the file system. Call it after reading.
  [[nodiscard]] std::optional<std::string> changed() const;
  /// Makes changed() ignore writes of other programs to a file that grows while it is followed.
  void tolerate_writes() const { tolerates_writes_ = true; }

 private:
  friend std::variant<MappedFile, FileError> map_file(const std::string& path, const CheckFirstBytes& check);
  friend std::optional<MappedFile> map_descriptor(Descriptor file);

  std::vector<std::byte> copy_;
  GuardedMapping mapping_;
  // open for mapped files only
  Descriptor file_;
  FileStamp stamp_;
  mutable bool tolerates_writes_ = false;
};

/// Opens a regular file, or a link to a regular file, for reading. Refuses folders, pipes, sockets and devices without
/// waiting. Calls `check` before it maps a file. Blocks while the disk is read. Any thread.
[[nodiscard]] std::variant<MappedFile, FileError> map_file(const std::string& path, const CheckFirstBytes& check = {});

/// Maps an open regular file that is not empty, of any size. Takes over its descriptor. Returns nullopt if the system
/// cannot map it.
[[nodiscard]] std::optional<MappedFile> map_descriptor(Descriptor file);

/// Regular file that is open for reading at any offset. Movable. One owner. Several threads may read at the same time.
/// If another program truncates the file, reads return fewer bytes.
class RandomAccessFile {
 public:
  /// Returns the size of the file in bytes at the time of opening.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Copies bytes from `offset` on into `to`. Returns the number of copied bytes. This is less than the size of `to` at
  /// the end of the file and after disk errors. Blocks while the disk is read.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const;

 private:
  friend std::variant<RandomAccessFile, FileError> open_file(const std::string& path);
  RandomAccessFile(Descriptor file, std::uint64_t size) : file_(std::move(file)), size_(size) {}

  Descriptor file_;
  std::uint64_t size_ = 0;
};

/// Opens a regular file, or a link to a regular file. Refuses the same files as map_file().
[[nodiscard]] std::variant<RandomAccessFile, FileError> open_file(const std::string& path);

/// Writes a file completely or not at all. Writes an unfinished file (unfinished_file.h) in the same folder, which then
/// replaces `path`. Keeps the access rights of the old file if possible. Follows a link. Replaces only regular files.
///
/// Returns nullopt on success. After an error, the old file is unchanged and no other file remains.
[[nodiscard]] std::optional<FileError> write_file_atomically(const std::string& path, std::span<const std::byte> bytes);

}  // namespace gs::net
