#pragma once

#include "net/base/descriptor.h"

#include <cstddef>
#include <string>

namespace gs::net {

/// New file that later replaces another one: `.ghostspace-PID-N` in the folder of that file. A lock (flock) marks it as
/// in use while this object lives, so that remove_unfinished_files() recognises leftovers of killed processes. Process
/// numbers cannot do that: systems reuse them, and containers have their own.
struct UnfinishedFile {
  std::string path;
  Descriptor file;  // open for writing; not open after a failure
  Descriptor lock;  // shares the lock of `file`, and keeps it after `file` is closed
};

/// Creates an unfinished file with the default access rights. `folder` ends with a slash. On failure, `file` is not
/// open and errno holds the reason.
[[nodiscard]] UnfinishedFile create_unfinished_file(const std::string& folder);

/// Removes the unfinished files that killed processes left in `folder`, and returns their number. Removes a file only
/// if its name has exactly the form above and it is a regular file of this user, with one name and without a lock.
/// Thread-safe.
std::size_t remove_unfinished_files(const std::string& folder);

}  // namespace gs::net
