#pragma once

#include "app/base/read_file.h"
#include "app/base/read_files.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace gs::app {

struct VolumeOrigin;

/// States of the files that the reader of a volume used, except the first one. They show whether the stored results of
/// an earlier run are still valid. Any thread.
class FileStates {
 public:
  void add(const std::string& reference, const SharedBytes& file);
  /// Adds the files below the folder of `path`, for a container with a file per chunk. text() lists them.
  void add_folder_of(const std::string& path);
  /// Adds the files that a VTK file names, such as pieces, which are read later. text() reads their headers.
  void add_members(const std::string& path, SharedBytes file, ReadFile read);
  /// Returns a text that changes if one of the files changes.
  [[nodiscard]] std::string text() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> states_;  // by reference
  std::string folder_, members_path_;
  SharedBytes members_file_;
  ReadFile read_member_;  // null if add_members() was not called
};

/// Wraps the functions of `origin` that read files, so that they record each file in VolumeOrigin::states. `path` and
/// `file` are the volume's own file. Has no effect if `states` is null.
void note_files(const std::string& path, const SharedBytes& file, VolumeOrigin& origin);

}  // namespace gs::app
