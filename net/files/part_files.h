#pragma once

#include "net/base/descriptor.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gs::net {

struct FileError;

/// Prepares a folder for the part files of several processes. Call before any process creates PartFiles. `key`
/// identifies the task. With `resume`, keeps files of this task, and returns an error for files of another task.
/// Without `resume`, removes files of any task. Returns an error if the folder cannot be used.
[[nodiscard]] std::optional<FileError> prepare_part_folder(const std::string& folder, const std::string& key,
                                                           bool resume);
/// Returns the lowest number above those of all part files in a folder.
[[nodiscard]] std::uint32_t free_part_number(const std::string& folder);
/// Returns the path of the stream that the processes of a folder write together.
[[nodiscard]] std::string part_stream(const std::string& folder);
/// Returns the path of a file beside `stream`. The first process that the system ends creates it.
[[nodiscard]] std::string part_end_mark(const std::string& stream);
/// Moves the stream of a folder to `path`, where it replaces a file. Removes the folder. Returns an error on failure.
[[nodiscard]] std::optional<FileError> publish_part_stream(const std::string& folder, const std::string& path);
/// Removes a folder of part files, and the files in it. Leaves other files.
void remove_part_folder(const std::string& folder);

/// Part files of a process in a folder that several processes share. Each process appends to its own files, and reads
/// the files of all processes, also of earlier runs. All processes must have access to the folder. Movable. One thread
/// appends; several may read.
class PartFiles {
 public:
  /// Maximum number of files, and of bytes in each.
  static constexpr std::uint32_t kMostParts = 1u << 20;
  static constexpr int kPartBits = 44;

  /// Creates files with the number `number`, and reads all lists of finished work. Returns an error on failure.
  [[nodiscard]] static std::variant<PartFiles, FileError> create(const std::string& folder, std::uint32_t number);

  /// Appends bytes to this process's file. Returns false on failure; problem() has the reason.
  [[nodiscard]] bool append(std::span<const std::byte> bytes);
  /// Returns the offset of the next appended byte. Its high bits are the number of the file.
  [[nodiscard]] std::uint64_t size() const { return (std::uint64_t{number_} << kPartBits) + bytes_; }
  /// Copies bytes of any file. Returns false if the file is too short or cannot be read.
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const;

  /// Records finished work: its bytes, which begin at `first`, and its result. Returns false on failure.
  [[nodiscard]] bool finish(std::string_view work, std::uint64_t first, std::span<const std::byte> result);
  /// Returns the result of work that was finished before these files were created. Returns nullopt if there is none, or
  /// if its bytes are damaged.
  [[nodiscard]] std::optional<std::vector<std::byte>> finished(std::string_view work) const;
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  /// Finished work: its bytes and their checksum, and the place of the result in a list.
  struct Work {
    std::uint64_t first = 0, end = 0;
    std::uint32_t checksum = 0, list = 0;
    std::uint64_t result = 0;
    std::uint32_t result_bytes = 0;
  };
  PartFiles() = default;
  void read_list(std::uint32_t number);
  [[nodiscard]] std::string path_of(std::uint32_t number, std::string_view ending) const;
  [[nodiscard]] std::optional<std::uint32_t> checksum_of(std::uint64_t first, std::uint64_t end) const;
  bool fail(const std::string& what);

  /// Open files of other processes.
  struct Readers {
    std::mutex mutex;
    std::map<std::uint32_t, Descriptor> files;
  };
  std::string folder_, problem_ = "a part file cannot be read";
  std::uint32_t number_ = 0;
  Descriptor data_, list_;
  std::uint64_t bytes_ = 0;
  std::uint64_t summed_from_ = 0;  // offset in this process's file from which checksum_ counts
  std::uint32_t checksum_ = 0;
  std::map<std::string, Work, std::less<>> finished_;
  std::unique_ptr<Readers> readers_;
};

}  // namespace gs::net
