#include "net/files/atomic_file.h"

#include "net/files/file_kind.h"

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

FileError cannot_write(const std::string& path, const std::string& why) {
  return {"cannot write " + path + ": " + why};
}
FileError cannot_write(const std::string& path, int code) {
  return cannot_write(path, std::generic_category().message(code));
}

/// Syncs the folder, so that the new name survives a power failure. Ignores errors: some file systems cannot do that.
void sync_folder(const std::string& folder) {
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened) (void)::fsync(opened.get());
}

}  // namespace

std::variant<AtomicFile, FileError> AtomicFile::begin(const std::string& path) {
  if (path.empty()) return FileError{"cannot write a file without a name"};
  if (path.find('\0') != std::string::npos) return FileError{"cannot write a file name with a zero byte"};
  AtomicFile made;
  made.path_ = made.target_ = path;
  struct stat status {};
  if (::lstat(path.c_str(), &status) == 0) {
    if (S_ISLNK(status.st_mode)) {
      std::error_code error;
      made.target_ = std::filesystem::canonical(path, error).string();
      if (error) return cannot_write(path, "it is a broken link: " + error.message());
      if (::stat(made.target_.c_str(), &status) != 0) return cannot_write(path, errno);
    }
    if (const auto what = not_a_regular_file(status)) return cannot_write(path, *what);
    // Write access to the folder must not override missing write access to the file.
    if (::access(made.target_.c_str(), W_OK) != 0) return cannot_write(path, errno);
    made.mode_ = status.st_mode & 07777;
  } else if (errno != ENOENT) {
    return cannot_write(path, errno);
  }
  const std::size_t slash = made.target_.rfind('/');
  made.folder_ = slash == std::string::npos ? "./" : made.target_.substr(0, slash + 1);
  made.unfinished_ = create_unfinished_file(made.folder_);
  if (!made.unfinished_.file) return cannot_write(path, errno);
  return made;
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      folder_(std::move(other.folder_)),
      mode_(other.mode_),
      unfinished_(std::move(other.unfinished_)),
      done_(std::exchange(other.done_, true)),
      problem_(std::move(other.problem_)) {}

AtomicFile::~AtomicFile() {
  if (!done_ && !unfinished_.path.empty()) ::unlink(unfinished_.path.c_str());
}

bool AtomicFile::write(std::span<const std::byte> bytes) {
  if (!problem_ && !write_all(unfinished_.file.get(), bytes)) problem_ = cannot_write(path_, errno);
  return !problem_;
}

bool AtomicFile::rewrite_front(std::span<const std::byte> bytes) {
  if (!problem_ && (::lseek(unfinished_.file.get(), 0, SEEK_SET) != 0 || !write_all(unfinished_.file.get(), bytes) ||
                    ::lseek(unfinished_.file.get(), 0, SEEK_END) < 0))
    problem_ = cannot_write(path_, errno);
  return !problem_;
}

std::optional<FileError> AtomicFile::commit() {
  if (problem_) return problem_;
  struct stat status {};
  const int file = unfinished_.file.get();
  // Change the mode only if it differs, because sandboxes may forbid fchmod.
  const bool other_mode = mode_ && (::fstat(file, &status) != 0 || (status.st_mode & 07777) != *mode_);
  if ((other_mode && ::fchmod(file, *mode_) != 0) || ::fsync(file) != 0 || !unfinished_.file.close() ||
      ::rename(unfinished_.path.c_str(), target_.c_str()) != 0)
    return cannot_write(path_, errno);
  done_ = true;
  sync_folder(folder_);
  return std::nullopt;
}

}  // namespace gs::net
