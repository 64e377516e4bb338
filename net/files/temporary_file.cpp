#include "net/files/temporary_file.h"

#include "net/files/file.h"

#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

// Creates a file without a name. File systems without O_TMPFILE get a name that is removed at once.
Descriptor create_unnamed(const std::string& folder) {
#ifdef O_TMPFILE
  if (Descriptor file(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600)); file) return file;
  if (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL) return {};
#endif
  std::string name = folder + "/.ghostspace-data-XXXXXX";
  Descriptor file(::mkostemp(name.data(), O_CLOEXEC));
  if (file) ::unlink(name.c_str());
  return file;
}

}  // namespace

std::variant<TemporaryFile, FileError> TemporaryFile::create(const std::string& folder) {
  const char* const own = std::getenv("TMPDIR");
  std::string where = !folder.empty() ? folder : own && *own ? own : "/tmp";
  Descriptor file = create_unnamed(where);
  if (!file)
    return FileError{"cannot create a temporary file in " + where + ": " + std::generic_category().message(errno)};
  return TemporaryFile(std::move(file), std::move(where));
}

bool TemporaryFile::append(std::span<const std::byte> bytes) {
  if (!write_all(file_.get(), bytes)) {
    problem_ = "cannot write " + std::to_string(bytes.size()) + " bytes to a temporary file in " + folder_ + ": " +
               std::generic_category().message(errno);
    return false;
  }
  size_ += bytes.size();
  return true;
}

bool TemporaryFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  if (offset > size_ || to.size() > size_ - offset) return false;
  while (!to.empty()) {
    const ssize_t got = ::pread(file_.get(), to.data(), to.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    offset += static_cast<std::uint64_t>(got);
    to = to.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

}  // namespace gs::net
