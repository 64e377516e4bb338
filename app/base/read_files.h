#pragma once

#include "app/base/read_file.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Consecutive bytes of a file.
struct FilePart {
  std::uint64_t offset = 0, bytes = 0;
  bool from_end = false;  // the last `bytes` bytes; `offset` has no meaning
};

/// Request for a file to which another file refers, or for a part of it.
struct FileRequest {
  std::string reference;  // URL reference, as for ReadFile
  std::optional<FilePart> part = {};
};

/// Result for a file that does not exist.
struct NoFile {
  std::string why = {};  // as a message; may be empty
};

/// Bytes of a file, or its absence, or the error message.
using FileResult = std::variant<SharedBytes, NoFile, std::string>;

/// Function that reads several files, those of a server in parallel. Returns one result per request, in their order.
/// The rules of ReadFile hold.
using ReadFiles = std::function<std::vector<FileResult>(std::span<const FileRequest> requests)>;

/// Function that lists the files and folders in a folder, without order. Returns nullopt if it cannot be listed, as
/// those of servers.
using ListFolder = std::function<std::optional<std::vector<std::string>>(const std::string& reference)>;

/// Returns the bytes of a part, or a message if the file is shorter.
[[nodiscard]] inline FileResult part_of(SharedBytes file, const std::optional<FilePart>& part) {
  if (!part) return file;
  const std::uint64_t size = file.bytes.size();
  const std::uint64_t offset = part->from_end ? size - std::min(size, part->bytes) : part->offset;
  if (part->bytes > size || offset > size - part->bytes)
    return "the file ends after " + std::to_string(size) + " bytes; expected " + std::to_string(part->bytes) +
           " bytes from " + std::to_string(offset);
  file.bytes = file.bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(part->bytes));
  return file;
}

}  // namespace gs::app
