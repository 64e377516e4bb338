#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "net/base/descriptor.h"

namespace gs::net {

/// A folder for files that are of no use to anyone else, gone with its owner. Movable. For the user alone (0700), and
/// locked (flock) as long as this process lives, however it ends: what a process that is gone left behind is told from
/// what is in use by its lock, not by numbers of processes, which come again, or by age.
class LockedFolder {
 public:
  /// A new one in `parent`, `prefix` with a random ending; or why there is none.
  [[nodiscard]] static std::variant<LockedFolder, std::string> make(const std::string& parent, std::string_view prefix);
  LockedFolder() = default;
  LockedFolder(LockedFolder&&) noexcept = default;
  LockedFolder& operator=(LockedFolder&& other) noexcept;
  LockedFolder(const LockedFolder&) = delete;
  LockedFolder& operator=(const LockedFolder&) = delete;
  /// Removes it with the files in it.
  ~LockedFolder();

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  void remove() noexcept;

  std::string path_;
  Descriptor locked_;
};

/// Removes what processes that are gone left in `parent` of such folders; how many. Nothing else is touched: a folder
/// counts only with exactly such a name, of this user, for this user alone, unlocked, and with nothing but regular
/// files in it. Any thread.
std::size_t remove_abandoned_folders(const std::string& parent, std::string_view prefix);

}  // namespace gs::net
