#include "net/files/file_stamp.h"

#include "net/base/siphash.h"

#include <array>
#include <cstdio>
#include <span>

#include <sys/stat.h>

namespace gs::net {

std::string FileStamp::etag(std::string_view suffix) const {
  const std::array<std::uint64_t, 4> facts{size, inode, static_cast<std::uint64_t>(seconds),
                                           static_cast<std::uint64_t>(nanoseconds)};
  char text[32];
  std::snprintf(text, sizeof text, "%016llx",
                static_cast<unsigned long long>(siphash(SipKey{}, std::as_bytes(std::span(facts)))));
  return "\"" + std::string(text) + std::string(suffix) + "\"";
}

FileStamp stamp_of(const Descriptor& descriptor) {
  struct stat status {};
  if (fstat(descriptor.get(), &status) != 0) return {};
  return {static_cast<std::uint64_t>(status.st_size), status.st_ino, status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

}  // namespace gs::net
