#include "net/files/unfinished_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

constexpr std::string_view kPrefix = ".ghostspace-";

/// Returns true if `text` has one to ten digits and no leading zero.
bool is_number(std::string_view text) {
  constexpr std::size_t kMaxDigits = 10;
  return !text.empty() && text.size() <= kMaxDigits && (text.front() != '0' || text.size() == 1) &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Returns true if the name has the form `.ghostspace-PID-N`.
bool is_unfinished_name(std::string_view name) {
  if (!name.starts_with(kPrefix)) return false;
  name.remove_prefix(kPrefix.size());
  const std::size_t dash = name.find('-');
  return dash != std::string_view::npos && is_number(name.substr(0, dash)) && is_number(name.substr(dash + 1));
}

/// Returns true if the file is regular, belongs to this user and has only one name.
bool is_own_file(const struct stat& status) {
  return S_ISREG(status.st_mode) && status.st_uid == ::geteuid() && status.st_nlink == 1;
}

/// Returns true if `name` in `folder` still refers to the open file.
bool is_same_file(int folder, const char* name, const Descriptor& file) {
  struct stat open {
  }, named{};
  return ::fstat(file.get(), &open) == 0 && ::fstatat(folder, name, &named, AT_SYMLINK_NOFOLLOW) == 0 &&
         is_own_file(open) && open.st_dev == named.st_dev && open.st_ino == named.st_ino;
}

/// Removes a file if no process uses it. Holds the lock until the name is removed, so that no writer begins to use it.
bool remove_leftover(int folder, const char* name) {
  struct stat status {};
  if (::fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) != 0 || !is_own_file(status)) return false;
  // NFS locks only files that are open for writing.
  const Descriptor file(::openat(folder, name, O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  return file && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0 && is_same_file(folder, name, file) &&
         ::unlinkat(folder, name, 0) == 0;
}

}  // namespace

UnfinishedFile create_unfinished_file(const std::string& folder) {
  static std::atomic<unsigned> counter{0};
  constexpr int kTries = 1000;
  UnfinishedFile made;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    made.path = folder + std::string(kPrefix) + std::to_string(::getpid()) + "-" + std::to_string(counter++);
    made.file = Descriptor(::open(made.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!made.file && errno == EEXIST) continue;
    if (!made.file) return made;
    made.lock = Descriptor(::fcntl(made.file.get(), F_DUPFD_CLOEXEC, 0));
    if (!made.lock) {
      const int code = errno;
      ::unlink(made.path.c_str());
      (void)made.file.close();
      errno = code;
      return made;
    }
    // Another process may remove the file before this process locks it. Without locks in the file system, none is ever
    // removed.
    const bool taken = ::flock(made.lock.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!taken && is_same_file(AT_FDCWD, made.path.c_str(), made.file)) return made;
    if (taken) ::unlink(made.path.c_str());
  }
  made.file = Descriptor();
  errno = EEXIST;
  return made;
}

std::size_t remove_unfinished_files(const std::string& folder) {
  const Descriptor open(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!open) return 0;
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (std::string name = entry->path().filename().string(); is_unfinished_name(name))
      names.push_back(std::move(name));
  return static_cast<std::size_t>(std::count_if(
      names.begin(), names.end(), [&](const std::string& name) { return remove_leftover(open.get(), name.c_str()); }));
}

}  // namespace gs::net
