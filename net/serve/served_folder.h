#pragma once

#include "net/base/descriptor.h"
#include "net/files/file_stamp.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::net {

/// Reason why a path of a request is not served, with an HTTP status (RFC 9110 15): 400, 403, 404, 414 or 500.
struct PathRefusal {
  int status = 404;
  std::string message;
};

/// Path of a request, split at slashes and percent-decoded.
struct RequestPath {
  std::vector<std::string> names;
  bool folder = false;  // ends with a slash

  /// Returns the path percent-encoded, such as "/a%20b/c".
  [[nodiscard]] std::string text() const;
};

/// Parses the path of a request's target, which begins with a slash and has no query. Refuses paths that could leave
/// the folder or are ambiguous: "." and "..", also encoded; NUL and other control characters; backslashes; encoded
/// slashes; empty names; invalid percent signs; more than 4096 bytes. Names that begin with a dot are not found.
[[nodiscard]] std::variant<RequestPath, PathRefusal> parse_request_path(std::string_view path);

/// Percent-encodes a name for a URL.
[[nodiscard]] std::string encode_name(std::string_view name);

/// Regular file or folder that is open for reading.
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
/// Files and folders of a folder that may be served: folders first, then by name.
struct FolderListing {
  std::string path;  // decoded, such as "/a/b/"
  std::vector<FolderEntry> entries;
  bool complete = true;  // false if there are more than kMaxEntries
  static constexpr std::size_t kMaxEntries = 10'000;
};

/// Folder outside of which nothing is opened. Any thread.
class ServedFolder {
 public:
  /// Opens a folder. If the kernel has openat2 (5.6), symbolic links are followed inside the folder. Otherwise, or
  /// without `resolve_beneath`, no links are followed.
  [[nodiscard]] static std::variant<ServedFolder, std::string> open(const std::string& path,
                                                                    bool resolve_beneath = true);

  /// Opens a regular file or a folder; refuses everything else.
  [[nodiscard]] std::variant<ServedFile, PathRefusal> open(const RequestPath& path) const;
  [[nodiscard]] FolderListing list(const RequestPath& path) const;
  /// Returns the real path of the folder.
  [[nodiscard]] std::string path() const { return real_path(root_); }
  /// Returns the real path of an open file, for programs that need a path.
  [[nodiscard]] static std::string real_path(const Descriptor& descriptor);

 private:
  ServedFolder(Descriptor root, bool resolve_beneath) : root_(std::move(root)), resolve_beneath_(resolve_beneath) {}
  [[nodiscard]] Descriptor open_beneath(int folder, const std::string& relative) const;
  Descriptor root_;
  bool resolve_beneath_;
};

}  // namespace gs::net
