#pragma once

#include "net/base/descriptor.h"
#include "net/files/file_stamp.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::net {

/// Query of the target of a made file, before a number: it is made only of a file with at least as many bytes.
inline constexpr const char* kLeastSizeQuery = "from=";

/// Reason why a requested path is not served, with an HTTP status (RFC 9110 15): 400, 403, 404, 414 or 500.
struct PathRefusal {
  int status = 404;
  std::string message;
};

/// Path of a request, split at slashes and percent-decoded.
struct RequestPath {
  std::vector<std::string> names;
  bool folder = false;  // the path ends with a slash
  std::size_t within = 0;  // number of leading names that form a folder which links must not leave; 0 means no limit

  /// Returns the path with percent-encoding, such as "/a%20b/c".
  [[nodiscard]] std::string text() const;
};

/// Parses the path of a request target. The path begins with a slash and has no query. Refuses paths that could leave
/// the folder or are ambiguous:
/// - "." and "..", also encoded;
/// - backslashes, encoded slashes, empty names and invalid percent signs;
/// - NUL and other control characters;
/// - more than 4096 bytes.
/// Returns 404 for names that begin with a dot, unless `hidden` is true.
[[nodiscard]] std::variant<RequestPath, PathRefusal> parse_request_path(std::string_view path, bool hidden = false);

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
  std::int64_t modified = 0;  // time of modification, Unix seconds
};
/// Servable files and folders in a folder. Folders are first; then the order is by name.
struct FolderListing {
  std::string path;  // decoded, such as "/a/b/"
  std::vector<FolderEntry> entries;
  bool complete = true;  // false if the folder has more than kMaxEntries entries
  static constexpr std::size_t kMaxEntries = 10'000;
};

/// Folder that limits which files can be opened. Any thread.
class ServedFolder {
 public:
  /// Opens a folder. If the kernel has openat2 (Linux 5.6), symbolic links inside the folder are followed. Otherwise,
  /// or without `resolve_beneath`, links are not followed. If `everywhere`, all links are followed, also out of the
  /// folder, except for paths with a limit (RequestPath::within).
  [[nodiscard]] static std::variant<ServedFolder, std::string> open(const std::string& path,
                                                                    bool resolve_beneath = true,
                                                                    bool everywhere = false);

  /// Opens a regular file or a folder. Refuses all other kinds of files.
  [[nodiscard]] std::variant<ServedFile, PathRefusal> open(const RequestPath& path) const;
  [[nodiscard]] FolderListing list(const RequestPath& path) const;
  /// Returns the real path of the folder.
  [[nodiscard]] std::string path() const { return real_path(root_); }
  /// Returns the real path of an open file, for programs that need a path.
  [[nodiscard]] static std::string real_path(const Descriptor& descriptor);

 private:
  ServedFolder(Descriptor root, bool resolve_beneath, bool everywhere)
      : root_(std::move(root)), resolve_beneath_(resolve_beneath), everywhere_(everywhere) {}
  [[nodiscard]] Descriptor open_path(const RequestPath& path) const;
  [[nodiscard]] Descriptor open_beneath(int folder, const std::string& relative) const;
  Descriptor root_;
  bool resolve_beneath_, everywhere_;
};

}  // namespace gs::net
