#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "net/base/descriptor.h"

namespace gs::net {

/// Private temporary folder (mode 0700) that its owner removes. Movable. A lock (flock) marks it as in use while this
/// process lives. Leftovers of ended processes are recognised by their missing lock, not by age or by process numbers,
/// which systems reuse.
class LockedFolder {
 public:
  /// Creates a folder in `parent`, named `prefix` with a random ending, or returns an error.
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

/// Removes the folders of ended processes in `parent`, and returns their number. Removes only folders with exactly such
/// a name, of this user, with mode 0700, without a lock, and with regular files only. Any thread.
std::size_t remove_abandoned_folders(const std::string& parent, std::string_view prefix);

}  // namespace gs::net
