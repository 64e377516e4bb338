#pragma once

#include "net/base/descriptor.h"
#include "net/files/file_stamp.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::net {

/// Why a path of a request is not served, as a status of HTTP (RFC 9110 15):
/// 400, 403, 404, 414 or 500.
struct PathRefusal {
  int status = 404;
  std::string message;
};

/// A path of a request, cut at its slashes and percent-decoded.
struct RequestPath {
  std::vector<std::string> names;
  bool folder = false;  // ends in a slash

  /// "/a%20b/c": percent-encoded again.
  [[nodiscard]] std::string text() const;
};

/// Reads the path of a request's target, which begins with a slash and has no
/// query. Refuses whatever could lead out of a folder or has no plain meaning:
/// "." and "..", also encoded; NUL and other control characters; backslashes;
/// encoded slashes; empty names; damaged percent signs; more than 4096 bytes.
/// Names that begin with a point are not found.
[[nodiscard]] std::variant<RequestPath, PathRefusal> parse_request_path(std::string_view path);

/// A percent-encoded name, fit for a URL.
[[nodiscard]] std::string encode_name(std::string_view name);

/// A regular file or a folder that is open for reading.
struct ServedFile {
  Descriptor descriptor;
  bool folder = false;
  FileStamp stamp;
};

struct FolderEntry {
  std::string name;
  bool folder = false;
  std::uint64_t size = 0;
  std::int64_t modified = 0;  // Unix seconds
};
/// The files and folders in a folder that may be served, folders first, then by
/// name.
struct FolderListing {
  std::string path;  // "/a/b/", decoded
  std::vector<FolderEntry> entries;
  bool complete = true;  // else there are more than kMostEntries
  static constexpr std::size_t kMostEntries = 10'000;
};

/// A folder, beyond which nothing is ever opened. Any thread.
class ServedFolder {
 public:
  /// Where the kernel has openat2 (5.6), symbolic links are followed as long as
  /// they stay in the folder; elsewhere, or without `resolve_beneath`, none
  /// are.
  [[nodiscard]] static std::variant<ServedFolder, std::string> open(const std::string& path,
                                                                    bool resolve_beneath = true);

  /// Regular files and folders only.
  [[nodiscard]] std::variant<ServedFile, PathRefusal> open(const RequestPath& path) const;
  [[nodiscard]] FolderListing list(const RequestPath& path) const;
  /// Where it really is.
  [[nodiscard]] std::string path() const { return real_path(root_); }
  /// Where an open file really is: for programs that need a path.
  [[nodiscard]] static std::string real_path(const Descriptor& descriptor);

 private:
  ServedFolder(Descriptor root, bool resolve_beneath) : root_(std::move(root)), resolve_beneath_(resolve_beneath) {}
  [[nodiscard]] Descriptor open_beneath(int folder, const std::string& relative) const;
  Descriptor root_;
  bool resolve_beneath_;
};

}  // namespace gs::net
