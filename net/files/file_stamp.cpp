#include "net/files/file_stamp.h"

#include "net/base/siphash.h"

#include <array>
#include <cstdio>
#include <span>

#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace gs::net {

std::string FileStamp::etag(std::string_view suffix) const {
  const std::array<std::uint64_t, 3> facts{size, static_cast<std::uint64_t>(seconds),
                                           static_cast<std::uint64_t>(nanoseconds)};
  char text[32];
  std::snprintf(text, sizeof text, "%016llx",
                static_cast<unsigned long long>(siphash(SipKey{}, std::as_bytes(std::span(facts)))));
  return "\"" + std::string(text) + std::string(suffix) + "\"";
}

bool read_status(int file, struct stat& status) {
#if defined(SYS_fstat) && defined(__LP64__)
  // fstat() of some C libraries uses a call that also accepts paths. Confined processes may not use that.
  return ::syscall(SYS_fstat, file, &status) == 0;
#else
  return ::fstat(file, &status) == 0;
#endif
}

FileStamp stamp_of(const Descriptor& descriptor) {
  struct stat status {};
  if (!read_status(descriptor.get(), status)) return {};
  return {static_cast<std::uint64_t>(status.st_size), status.st_ino, status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

}  // namespace gs::net
