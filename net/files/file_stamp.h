#pragma once

#include "net/base/descriptor.h"

#include <cstdint>
#include <string>
#include <string_view>

#include <sys/stat.h>

namespace gs::net {

/// Stamp of a file version: size, inode and time of modification.
struct FileStamp {
  std::uint64_t size = 0, inode = 0;
  std::int64_t seconds = 0, nanoseconds = 0;  // time of modification, Unix time
  friend bool operator==(const FileStamp&, const FileStamp&) = default;

  /// Returns a strong entity tag (RFC 9110 8.8.3) from size and time, equal for copies that keep the time. `suffix`
  /// distinguishes forms of the file. Two versions of equal size and equal time get equal tags.
  [[nodiscard]] std::string etag(std::string_view suffix = {}) const;
};
/// Reads the status of an open file with a system call that has no path, also in confined processes. Returns false and
/// sets errno on failure.
[[nodiscard]] bool read_status(int file, struct stat& status);
/// Returns the stamp of an open file. Returns zeros if the system does not report the values.
[[nodiscard]] FileStamp stamp_of(const Descriptor& descriptor);

}  // namespace gs::net
