#include "net/serve/served_folder.h"

#include "net/base/hexadecimal.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <span>

#include <dirent.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>

namespace gs::net {
namespace {

constexpr std::size_t kMaxPathBytes = 4096;
// O_NONBLOCK: the server must not wait for the other end of a pipe.
constexpr int kFlags = O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY;

bool is_plain(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
         std::strchr("-._~", c) != nullptr;
}

// Percent-decodes a text. Returns nullopt if a percent sign is invalid.
std::optional<std::string> decode(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    if (i + 2 >= text.size() || hexadecimal_value(text[i + 1]) < 0 || hexadecimal_value(text[i + 2]) < 0)
      return std::nullopt;
    out += static_cast<char>(hexadecimal_value(text[i + 1]) * 16 + hexadecimal_value(text[i + 2]));
    i += 2;
  }
  return out;
}

// Returns the reason why a decoded name must not be opened. Status 0 means that it may be opened.
PathRefusal refuse_name(const std::string& name, bool hidden = false) {
  if (name.empty()) return {404, "empty name in the path"};
  if (name == "." || name == "..") return {400, "'.' and '..' are not allowed in a path"};
  for (const char c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\' || c == '/')
      return {400, "a name must not have control characters, slashes or backslashes"};
  if (name.front() == '.' && !hidden) return {404, "not found"};
  if (name.size() > 255) return {404, "not found"};
  return {0, {}};
}

std::string joined(std::span<const std::string> names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : "/") + name;
  return text.empty() ? "." : text;
}

PathRefusal refusal_of(int error) {
  if (error == ENOENT || error == ENOTDIR || error == ELOOP || error == EXDEV || error == ENAMETOOLONG ||
      error == ENXIO)
    return {404, "not found"};
  if (error == EACCES || error == EPERM) return {403, "may not be read"};
  return {500, "cannot be opened"};
}

}  // namespace

std::string encode_name(std::string_view name) {
  std::string text;
  for (const char c : name) {
    char code[4];
    std::snprintf(code, sizeof code, "%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    if (is_plain(c) && c != '\0') {
      text += c;
    } else {
      text += code;
    }
  }
  return text;
}

std::string RequestPath::text() const {
  std::string all;
  for (const std::string& name : names) all += "/" + encode_name(name);
  return folder || all.empty() ? all + "/" : all;
}

std::variant<RequestPath, PathRefusal> parse_request_path(std::string_view path, bool hidden) {
  if (path.size() > kMaxPathBytes) return PathRefusal{414, "the path is longer than 4096 bytes"};
  if (path.empty() || path.front() != '/') return PathRefusal{400, "a path must begin with '/'"};
  path.remove_prefix(1);
  RequestPath result;
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('/'), path.size());
    const auto name = decode(path.substr(0, end));
    if (!name) return PathRefusal{400, "a percent sign must be followed by two hexadecimal digits"};
    PathRefusal refusal = refuse_name(*name, hidden);
    if (refusal.status != 0) return refusal;
    result.names.push_back(*name);
    result.folder = end < path.size();
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  if (result.names.empty()) result.folder = true;
  return result;
}

std::variant<ServedFolder, std::string> ServedFolder::open(const std::string& path, bool resolve_beneath,
                                                           bool everywhere) {
  Descriptor root(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!root) return path + ": " + std::strerror(errno) + "; expected a folder";
  ServedFolder folder(std::move(root), resolve_beneath, everywhere);
  if (resolve_beneath && !folder.open_beneath(folder.root_.get(), ".") && (errno == ENOSYS || errno == EPERM))
    folder.resolve_beneath_ = false;
  return folder;
}

// Opens a path of a request. Returns an empty descriptor and sets errno on failure.
Descriptor ServedFolder::open_path(const RequestPath& path) const {
  const auto names = std::span(path.names);
  if (!everywhere_) return open_beneath(root_.get(), joined(names));
  const std::size_t outer = std::min(path.within, names.size());
  const std::string first = joined(names.first(path.within > 0 ? outer : names.size()));
  Descriptor opened(::openat(root_.get(), first.c_str(), kFlags | (path.within > 0 ? O_DIRECTORY : 0)));
  return !opened || path.within == 0 ? std::move(opened) : open_beneath(opened.get(), joined(names.subspan(outer)));
}

// Opens a path inside the folder. Returns an empty descriptor and sets errno on failure.
Descriptor ServedFolder::open_beneath(int folder, const std::string& relative) const {
  if (resolve_beneath_) {
    open_how how{};
    how.flags = static_cast<std::uint64_t>(kFlags);
    how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
    // openat2 returns EAGAIN if another program renames files at the same time.
    for (int attempt = 0; attempt < 8; ++attempt) {
      Descriptor opened(static_cast<int>(syscall(SYS_openat2, folder, relative.c_str(), &how, sizeof how)));
      if (opened || errno != EAGAIN) return opened;
    }
    return Descriptor{};
  }
  Descriptor at;
  for (std::size_t begin = 0; begin <= relative.size();) {
    const std::size_t end = std::min(relative.find('/', begin), relative.size());
    const int flags = kFlags | O_NOFOLLOW | (end < relative.size() ? O_DIRECTORY : 0);
    Descriptor next(::openat(at ? at.get() : folder, relative.substr(begin, end - begin).c_str(), flags));
    if (!next) return next;
    at = std::move(next);
    begin = end + 1;
  }
  return at;
}

std::variant<ServedFile, PathRefusal> ServedFolder::open(const RequestPath& path) const {
  ServedFile file;
  file.descriptor = open_path(path);
  if (!file.descriptor) return refusal_of(errno);
  struct stat status {};
  if (fstat(file.descriptor.get(), &status) != 0) return PathRefusal{500, "cannot be read"};
  file.folder = S_ISDIR(status.st_mode);
  if (!file.folder && (!S_ISREG(status.st_mode) || path.folder)) return PathRefusal{404, "not found"};
  file.stamp = stamp_of(file.descriptor);
  return file;
}

FolderListing ServedFolder::list(const RequestPath& path) const {
  FolderListing listing;
  listing.path = "/";
  for (const std::string& name : path.names) listing.path += name + "/";
  Descriptor folder = open_path(path);
  if (!folder) return listing;
  const int number = folder.get();
  const auto close = [](DIR* open) { ::closedir(open); };
  const std::unique_ptr<DIR, decltype(close)> names(::fdopendir(::fcntl(number, F_DUPFD_CLOEXEC, 0)), close);
  if (!names) return listing;
  while (const dirent* entry = ::readdir(names.get())) {
    const std::string name = entry->d_name;
    if (refuse_name(name).status != 0) continue;
    if (listing.entries.size() == FolderListing::kMaxEntries) {
      listing.complete = false;
      break;
    }
    const Descriptor opened =
        everywhere_ ? Descriptor(::openat(number, name.c_str(), kFlags)) : open_beneath(number, name);
    struct stat status {};
    if (!opened || fstat(opened.get(), &status) != 0) continue;
    if (!S_ISDIR(status.st_mode) && !S_ISREG(status.st_mode)) continue;
    listing.entries.push_back(
        {name, S_ISDIR(status.st_mode), static_cast<std::uint64_t>(status.st_size), status.st_mtim.tv_sec});
  }
  std::sort(listing.entries.begin(), listing.entries.end(), [](const FolderEntry& a, const FolderEntry& b) {
    return a.folder != b.folder ? a.folder : a.name < b.name;
  });
  return listing;
}

std::string ServedFolder::real_path(const Descriptor& descriptor) {
  char path[4097];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor.get());
  const ssize_t length = ::readlink(link.c_str(), path, sizeof path - 1);
  return length > 0 ? std::string(path, static_cast<std::size_t>(length)) : std::string();
}

}  // namespace gs::net
