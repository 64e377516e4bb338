#pragma once

#include "base/noncopyable.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::simulation {

using Bytes = std::shared_ptr<const std::vector<std::byte>>;

/// File that sessions load, in two versions of different sizes.
struct Content {
  std::string name;
  Bytes versions[2];
};

/// Returns all files: streams of each kind, and plain files. Made once.
[[nodiscard]] const std::vector<Content>& contents();

/// Temporary folder of a server, with a folder for the cache of its clients. Removed at the end.
class ServedFiles : NonCopyable {
 public:
  ServedFiles();
  ~ServedFiles();

  [[nodiscard]] std::string folder() const { return base_ + "/www"; }
  [[nodiscard]] std::string cache() const { return base_ + "/cache"; }
  /// Replaces a file by one of its versions, as an upload does: by renaming. `modified` is in seconds, Unix time.
  void put(const Content& content, int version, std::int64_t modified) const;

 private:
  std::string base_;
};

}  // namespace gs::simulation
