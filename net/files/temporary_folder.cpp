#include "net/files/temporary_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

constexpr std::size_t kEnding = 6;  // number of random characters that mkdtemp appends

bool is_name_of(std::string_view name, std::string_view prefix) {
  if (name.size() != prefix.size() + 1 + kEnding || !name.starts_with(prefix) || name[prefix.size()] != '-')
    return false;
  const std::string_view ending = name.substr(prefix.size() + 1);
  return std::all_of(ending.begin(), ending.end(),
                     [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); });
}

// Reports whether the open folder is still at `path` and belongs only to this user.
bool is_folder_of_ours(const Descriptor& folder, const std::string& path) {
  struct stat open {
  }, there{};
  return ::fstat(folder.get(), &open) == 0 && ::lstat(path.c_str(), &there) == 0 && S_ISDIR(there.st_mode) &&
         open.st_dev == there.st_dev && open.st_ino == there.st_ino && open.st_uid == ::geteuid() &&
         (open.st_mode & 077) == 0;
}

Descriptor open_folder(const std::string& path) {
  return Descriptor(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
}

// Removes the files of a folder. Returns false and removes nothing if the folder contains anything except regular
// files.
bool remove_files(const Descriptor& folder, const std::string& path) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator file(path, error), end; !error && file != end; file.increment(error)) {
    struct stat status {};
    const std::string name = file->path().filename().string();
    if (::fstatat(folder.get(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(status.st_mode))
      return false;
    names.push_back(name);
  }
  for (const std::string& name : names) (void)::unlinkat(folder.get(), name.c_str(), 0);
  return !error;
}

}  // namespace

std::variant<LockedFolder, std::string> LockedFolder::make(const std::string& parent, std::string_view prefix) {
  constexpr int kTries = 100;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    std::string path = parent + "/" + std::string(prefix) + "-" + std::string(kEnding, 'X');
    if (!::mkdtemp(path.data()))
      return "cannot create a folder in " + parent + ": " + std::generic_category().message(errno);
    Descriptor folder = open_folder(path);
    // Give up if a concurrent cleanup holds the lock. Continue without a lock if the file system has no locks: then no
    // cleanup runs.
    if (!folder || (::flock(folder.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) ||
        !is_folder_of_ours(folder, path))
      continue;
    LockedFolder made;
    made.path_ = std::move(path);
    made.locked_ = std::move(folder);
    return made;
  }
  return "cannot create a folder in " + parent;
}

LockedFolder& LockedFolder::operator=(LockedFolder&& other) noexcept {
  if (this == &other) return *this;
  remove();
  path_ = std::move(other.path_);
  locked_ = std::move(other.locked_);
  return *this;
}

LockedFolder::~LockedFolder() { remove(); }

void LockedFolder::remove() noexcept {
  if (!locked_) return;
  try {
    (void)remove_files(locked_, path_);
  } catch (const std::bad_alloc&) {
    // If removal fails, a later start removes the folder.
  }
  (void)::rmdir(path_.c_str());
  locked_.close();
}

std::size_t remove_abandoned_folders(const std::string& parent, std::string_view prefix) {
  std::size_t removed = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(parent, error), end; !error && entry != end; entry.increment(error)) {
    const std::string path = entry->path().string();
    if (!is_name_of(entry->path().filename().string(), prefix)) continue;
    const Descriptor folder = open_folder(path);
    if (!folder || ::flock(folder.get(), LOCK_EX | LOCK_NB) != 0 || !is_folder_of_ours(folder, path)) continue;
    if (remove_files(folder, path) && ::rmdir(path.c_str()) == 0) ++removed;
  }
  return removed;
}

}  // namespace gs::net
