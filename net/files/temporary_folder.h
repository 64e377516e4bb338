#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "net/base/descriptor.h"

namespace gs::net {

/// Private temporary folder (mode 0700). The owner removes it. Movable. A lock (flock) marks the folder as in use while
/// this process runs. A missing lock identifies folders of ended processes. Age and process ids cannot, because systems
/// reuse ids.
class LockedFolder {
 public:
  /// Creates a folder in `parent`. Its name is `prefix` with a random ending. Returns an error on failure.
  [[nodiscard]] static std::variant<LockedFolder, std::string> make(const std::string& parent, std::string_view prefix);
  LockedFolder() = default;
  LockedFolder(LockedFolder&&) noexcept = default;
  LockedFolder& operator=(LockedFolder&& other) noexcept;
  LockedFolder(const LockedFolder&) = delete;
  LockedFolder& operator=(const LockedFolder&) = delete;
  /// Removes the folder and its files.
  ~LockedFolder();

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  void remove() noexcept;

  std::string path_;
  Descriptor locked_;
};

/// Removes the folders that ended processes left in `parent`. Returns the number of removed folders. Removes a folder
/// only if it has exactly such a name, belongs to this user, has mode 0700, is not locked and holds only regular files.
/// Any thread.
std::size_t remove_abandoned_folders(const std::string& parent, std::string_view prefix);

}  // namespace gs::net
