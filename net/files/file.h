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

/// Why a file could not be read or written; names the file.
struct FileError {
  std::string message;
};

/// Checks the first bytes (at most 8 KiB) of a file. Returns why it must not be read, or nullopt.
using CheckFirstBytes = std::function<std::optional<std::string>(std::span<const std::byte> first)>;

/// The bytes of a regular file, read-only. Movable; one owner; any thread.
///
/// Small files are copied. Larger ones are mapped, so that they take no memory that the system cannot take back: who
/// truncates one meanwhile makes its missing bytes zeros, and who writes to it changes what is read; `changed` tells of
/// both. Nothing that is done to the file ends the program.
class MappedFile {
 public:
  /// From this size on a file is mapped instead of copied.
  static constexpr std::size_t kMappedSize = std::size_t{1} << 20;

  /// All bytes; empty for an empty file.
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return mapping_.bytes().empty() ? std::span<const std::byte>(copy_) : mapping_.bytes();
  }
  /// Whoever goes through a large file once need not keep the first `size` bytes, which he has read, in memory.
  void put_aside(std::size_t size) const { mapping_.put_aside(size); }
  /// What to say of the file when the bytes may not be those of the moment of opening: it became shorter, or was
  /// written to. Nothing as long as they are, as far as the clock of the file system tells. To be asked after reading.
  [[nodiscard]] std::optional<std::string> changed() const;

 private:
  friend std::variant<MappedFile, FileError> map_file(const std::string& path, const CheckFirstBytes& check);

  std::vector<std::byte> copy_;
  GuardedMapping mapping_;
  // Of a mapped one:
  Descriptor file_;
  FileStamp stamp_;
};

/// Opens a regular file (or a link to one) for reading. Folders, pipes, sockets and devices are refused
/// without waiting for them. Calls `check` for files that would be mapped, before it maps them. Blocks as long as the
/// disk does; any thread.
[[nodiscard]] std::variant<MappedFile, FileError> map_file(const std::string& path, const CheckFirstBytes& check = {});

/// A regular file that is open for reading here and there. Movable; one owner; any number of threads may read at once.
/// Someone who truncates it meanwhile makes a reader get less, and nothing worse.
class RandomAccessFile {
 public:
  /// How long it was when it was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Copies what stands from `offset` on; how many bytes came: fewer than `to` has at the end of the file, and where
  /// the disk fails. Blocks as long as the disk does.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const;

 private:
  friend std::variant<RandomAccessFile, FileError> open_file(const std::string& path);
  RandomAccessFile(Descriptor file, std::uint64_t size) : file_(std::move(file)), size_(size) {}

  Descriptor file_;
  std::uint64_t size_ = 0;
};

/// Opens a regular file (or a link to one); refuses what map_file refuses.
[[nodiscard]] std::variant<RandomAccessFile, FileError> open_file(const std::string& path);

/// Writes a file as a whole or not at all: into a new file of the same folder (unfinished_file.h), which then takes the
/// place of the old one and, if possible, its access rights. Refuses to replace anything but a regular file; follows a
/// link. After an error, the old file is unchanged and no other file is left. Returns nullopt on success.
[[nodiscard]] std::optional<FileError> write_file_atomically(const std::string& path, std::span<const std::byte> bytes);

}  // namespace gs::net
