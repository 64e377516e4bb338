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

/// Prepares a folder for the part files of several processes, before any of them creates PartFiles. `key` identifies
/// the task. With `resume`, files of the same task stay, and those of another task are an error. Without it,
/// files of any task are removed. Returns an error if the folder cannot be used.
[[nodiscard]] std::optional<FileError> prepare_part_folder(const std::string& folder, const std::string& key,
                                                           bool resume);
/// Returns the lowest number above those of all part files in a folder.
[[nodiscard]] std::uint32_t free_part_number(const std::string& folder);
/// Returns the path of the stream that the processes of a folder write together.
[[nodiscard]] std::string part_stream(const std::string& folder);
/// Returns the path of a file that the first of these processes creates when the system ends them.
[[nodiscard]] std::string part_end_mark(const std::string& stream);
/// Gives that stream its final name, where it replaces a file, and removes the folder. Returns an error on failure.
[[nodiscard]] std::optional<FileError> publish_part_stream(const std::string& folder, const std::string& path);
/// Removes a folder of part files, and the files in it. Leaves other files.
void remove_part_folder(const std::string& folder);

/// Results of a process that shares a folder with others. Each process appends to files of its own, and reads those of
/// all, also of earlier runs. The folder must be on a file system that all processes see. Movable. One thread appends;
/// several may read.
class PartFiles {
 public:
  /// Maximum number of files, and of bytes in each.
  static constexpr std::uint32_t kMostParts = 1u << 20;
  static constexpr int kPartBits = 44;

  /// Creates the files `number`, and reads the lists of finished work of all files. Returns an error on failure.
  [[nodiscard]] static std::variant<PartFiles, FileError> create(const std::string& folder, std::uint32_t number);

  /// Adds bytes to the own file. Returns false on failure; problem() has the reason.
  [[nodiscard]] bool append(std::span<const std::byte> bytes);
  /// Returns the offset of the next byte. Its high bits are the number of the file.
  [[nodiscard]] std::uint64_t size() const { return (std::uint64_t{number_} << kPartBits) + bytes_; }
  /// Copies bytes of any file. Returns false if there are fewer, or if they cannot be read.
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const;

  /// Records that work is finished: it added the bytes from `first` on, and has a result. Returns false on failure.
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

  /// Files of other processes that are open.
  struct Readers {
    std::mutex mutex;
    std::map<std::uint32_t, Descriptor> files;
  };
  std::string folder_, problem_ = "a part file cannot be read";
  std::uint32_t number_ = 0;
  Descriptor data_, list_;
  std::uint64_t bytes_ = 0;
  std::uint64_t summed_from_ = 0;  // begin of the bytes that checksum_ has, in the own file
  std::uint32_t checksum_ = 0;
  std::map<std::string, Work, std::less<>> finished_;
  std::unique_ptr<Readers> readers_;
};

}  // namespace gs::net
