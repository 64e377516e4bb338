#pragma once

#include "net/base/descriptor.h"

#include <cstddef>
#include <string>

namespace gs::net {

/// New file that later replaces another file. Its name is `.ghostspace-PID-N` in the folder of that file. A lock
/// (flock) marks it as in use while this object exists. A missing lock identifies files of killed processes. Process
/// ids cannot: systems reuse them, and each container counts its own.
struct UnfinishedFile {
  std::string path;
  Descriptor file;  // open for writing; closed after a failure
  Descriptor lock;  // holds the lock of `file` after `file` is closed
};

/// Creates an unfinished file with default access rights. `folder` ends with a slash. On failure, `file` is closed and
/// errno has the reason.
[[nodiscard]] UnfinishedFile create_unfinished_file(const std::string& folder);

/// Removes the unfinished files that killed processes left in `folder`. Returns the number of removed files. Removes a
/// file only if its name has exactly that form, and if it is a regular file of this user with one name and no lock.
/// Thread-safe.
std::size_t remove_unfinished_files(const std::string& folder);

}  // namespace gs::net
