#pragma once

#include "net/base/descriptor.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace gs::net {

/// What tells versions of a file apart.
struct FileStamp {
  std::uint64_t size = 0, inode = 0;
  std::int64_t seconds = 0, nanoseconds = 0;  // modified, Unix time
  friend bool operator==(const FileStamp&, const FileStamp&) = default;

  /// A strong entity tag (RFC 9110 8.8.3) with its quotes; `suffix` tells
  /// representations apart. Strong as far as the file system's clock goes: two
  /// changes within its tick that keep the length look the same.
  [[nodiscard]] std::string etag(std::string_view suffix = {}) const;
};
/// Of an open descriptor; a size of 0 and nothing else where the system does
/// not tell.
[[nodiscard]] FileStamp stamp_of(const Descriptor& descriptor);

}  // namespace gs::net
