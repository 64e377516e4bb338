#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

namespace gs::net {

/// Why a file could not be read or written; names the file.
struct FileError {
  std::string message;
};

/// The bytes of a regular file, mapped read-only and private. Movable; one owner.
///
/// The bytes are those of the moment of mapping as long as no one changes the file. Someone who
/// truncates it meanwhile makes reading past its new end a SIGBUS, as with every mapping; files
/// smaller than kMappedSize are therefore copied, and so are files that the system cannot map.
class MappedFile {
 public:
  /// From this size on a file is mapped instead of read.
  static constexpr std::size_t kMappedSize = std::size_t{1} << 20;

  MappedFile() = default;
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  /// All bytes; empty for an empty file.
  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  friend std::variant<MappedFile, FileError> map_file(const std::string& path);
  void release() noexcept;

  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  bool mapped_ = false;  // else from malloc
};

/// Opens a regular file (or a link to one) for reading. Folders, pipes, sockets and devices are refused
/// without waiting for them. Blocks as long as the disk does; any thread.
[[nodiscard]] std::variant<MappedFile, FileError> map_file(const std::string& path);

/// A regular file that is open for reading here and there. Movable; one owner; any number of threads may read at once.
/// Someone who truncates it meanwhile makes a reader get less, and nothing worse.
class RandomAccessFile {
 public:
  RandomAccessFile(RandomAccessFile&& other) noexcept;
  RandomAccessFile& operator=(RandomAccessFile&& other) noexcept;
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;
  ~RandomAccessFile();

  /// How long it was when it was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Copies what stands from `offset` on; how many bytes came: fewer than `to` has at the end of the file, and where
  /// the disk fails. Blocks as long as the disk does.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const;

 private:
  friend std::variant<RandomAccessFile, FileError> open_file(const std::string& path);
  RandomAccessFile(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}

  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// Opens a regular file (or a link to one); refuses what map_file refuses.
[[nodiscard]] std::variant<RandomAccessFile, FileError> open_file(const std::string& path);

/// Writes a file as a whole or not at all: into a new file of the same folder, which then takes the
/// place (and, where it can, the access rights) of the old one. Refuses to replace what is not a regular
/// file; a link is followed. After an error the old file is as it was, and no other is left behind.
/// Nothing when it worked.
[[nodiscard]] std::optional<FileError> write_file_atomically(const std::string& path, std::span<const std::byte> bytes);

}  // namespace gs::net
