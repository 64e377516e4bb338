#pragma once

#include "app/base/read_file.h"
#include "app/base/read_files.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace gs::app {

struct VolumeOrigin;

/// States of the files that the reader of a volume used, except the first one. For results that an earlier run of the
/// program stored. Any thread.
class FileStates {
 public:
  void add(const std::string& reference, const SharedBytes& file);
  /// Adds the files below the folder of `path`, for a container with a file per chunk. text() lists them.
  void add_folder_of(const std::string& path);
  /// Adds the files that VTK files name, such as pieces, which are read later. text() reads their headers.
  void add_members(const std::string& path, SharedBytes file, ReadFile read);
  /// Returns a text that differs if one of the files differs.
  [[nodiscard]] std::string text() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> states_;  // by reference
  std::string folder_, members_path_;
  SharedBytes members_file_;
  ReadFile read_member_;  // null without such files
};

/// Makes `origin` note the files that it reads in VolumeOrigin::states. `path` and `file` are the file of the volume. Has
/// no effect without states.
void note_files(const std::string& path, const SharedBytes& file, VolumeOrigin& origin);

}  // namespace gs::app
