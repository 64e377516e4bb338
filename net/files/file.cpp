#include "net/files/file.h"

#include "net/base/descriptor.h"
#include "net/files/atomic_file.h"
#include "net/files/file_kind.h"

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

std::string reason(int code) { return std::generic_category().message(code); }

FileError cannot_open(const std::string& path, const std::string& why) { return {"cannot open " + path + ": " + why}; }

/// Regular file that is open for reading.
struct Regular {
  Descriptor file;
  std::uint64_t size = 0;
};

std::variant<Regular, FileError> open_regular(const std::string& path) {
  if (path.empty()) return FileError{"cannot open a file without a name"};
  if (path.find('\0') != std::string::npos) return FileError{"cannot open a file name with a zero byte"};
  // O_NONBLOCK: do not wait for the other end of a pipe. O_NOCTTY: do not make a terminal the controlling terminal.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  struct stat status {};
  if (!file) {
    const int code = errno;
    // open() fails for a socket with an unclear message, so report the kind of the file.
    if (::stat(path.c_str(), &status) == 0)
      if (const auto what = not_a_regular_file(status)) return cannot_open(path, *what);
    return cannot_open(path, reason(code));
  }
  if (::fstat(file.get(), &status) != 0) return cannot_open(path, reason(errno));
  if (const auto what = not_a_regular_file(status)) return cannot_open(path, *what);
  return Regular{std::move(file), static_cast<std::uint64_t>(status.st_size)};
}

/// Reads up to `size` bytes. Returns fewer if the file became shorter. Returns -1 and sets errno on disk errors.
ssize_t read_all(int file, std::byte* to, std::size_t size) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::read(file, to + done, size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return static_cast<ssize_t>(done);
}

}  // namespace

bool write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

std::optional<std::string> MappedFile::changed() const {
  if (!file_) return std::nullopt;
  if (!mapping_.lost() && (tolerates_writes_ || stamp_of(file_) == stamp_)) return std::nullopt;
  return "the file changed while it was read; reload to get the new version";
}

std::size_t RandomAccessFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  std::size_t done = 0;
  while (done < to.size() && offset + done < size_) {
    const ssize_t got = ::pread(file_.get(), to.data() + done, to.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

std::variant<RandomAccessFile, FileError> open_file(const std::string& path) {
  auto opened = open_regular(path);
  if (auto* error = std::get_if<FileError>(&opened)) return std::move(*error);
  auto& [file, size] = std::get<Regular>(opened);
  return RandomAccessFile(std::move(file), size);
}

std::variant<MappedFile, FileError> map_file(const std::string& path, const CheckFirstBytes& check) {
  auto opened = open_regular(path);
  if (auto* error = std::get_if<FileError>(&opened)) return std::move(*error);
  auto& [file, length] = std::get<Regular>(opened);
  const auto size = static_cast<std::size_t>(length);
  MappedFile result;
  if (size >= MappedFile::kMappedSize) {
    if (check) {
      std::array<std::byte, 8192> first;
      const ssize_t count = ::pread(file.get(), first.data(), first.size(), 0);
      if (count < 0) return FileError{"cannot read " + path + ": " + reason(errno)};
      if (const auto why = check(std::span(first).first(static_cast<std::size_t>(count))))
        return cannot_open(path, *why);
    }
    result.stamp_ = stamp_of(file);
    if (auto mapping = GuardedMapping::of(file.get(), size)) {
      result.mapping_ = std::move(*mapping);
      result.file_ = std::move(file);
      return result;
    }
  }
  result.copy_.resize(size);
  const ssize_t count = read_all(file.get(), result.copy_.data(), size);
  if (count < 0) return FileError{"cannot read " + path + ": " + reason(errno)};
  result.copy_.resize(static_cast<std::size_t>(count));
  return result;
}

std::optional<MappedFile> map_descriptor(Descriptor file) {
  struct stat status {};
  if (!file || !read_status(file.get(), status) || !S_ISREG(status.st_mode) || status.st_size <= 0) return std::nullopt;
  auto mapping = GuardedMapping::of(file.get(), static_cast<std::size_t>(status.st_size));
  if (!mapping) return std::nullopt;
  MappedFile result;
  result.stamp_ = stamp_of(file);
  result.mapping_ = std::move(*mapping);
  result.file_ = std::move(file);
  return result;
}

std::optional<FileError> write_file_atomically(const std::string& path, std::span<const std::byte> bytes) {
  auto begun = AtomicFile::begin(path);
  if (auto* problem = std::get_if<FileError>(&begun)) return std::move(*problem);
  auto& file = std::get<AtomicFile>(begun);
  file.write(bytes);
  return file.commit();
}

}  // namespace gs::net
