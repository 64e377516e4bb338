#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "net/base/address_space.h"
#include "net/base/url.h"

namespace gs::net {

/// Source of a document. Relative references are resolved against it, and it decides which references are allowed. The
/// content of a data: URL has the origin of the document that contains the URL.
struct Origin {
  // URL of the document after redirects; empty means the user, with access to everything
  std::string url;
  AddressSpace space = AddressSpace::special;  // space of the host that sent the document; unused for files

  [[nodiscard]] bool is_user() const { return url.empty(); }
  /// Reports whether the origin is a file of this machine. All other origins except the user are untrusted.
  [[nodiscard]] bool is_file() const { return has_scheme(url, "file"); }
  /// Returns the site of the origin. Documents of a site may refer to their own site. All files are one site.
  [[nodiscard]] std::string site() const;
  /// Returns the most private space to which the document may refer.
  [[nodiscard]] AddressSpace reach() const;

  friend bool operator==(const Origin&, const Origin&) = default;
};

/// Reason why a document may not refer to a URL or file.
struct ReferenceRefusal {
  std::string message;
  std::string folder;  // if the user allows this folder, the reference is allowed; empty if no folder helps
};

/// Rule for the references in all file formats (docs/security.md). Copyable. Const functions: any thread, but not
/// during `allow`.
class ReferencePolicy {
 public:
  /// Allows all files to refer to `path`, a file or a folder with its contents. Follows links now. Does nothing if the
  /// path does not exist.
  void allow(const std::string& path);

  /// Returns the reason why a document from `from` may not refer to `to`. Returns nullopt if it may. Reads the disk if
  /// `to` is a file.
  [[nodiscard]] std::optional<ReferenceRefusal> refuse(const Origin& from, const Url& to) const;
  /// Checks a reference to a file, after links in `path` are followed. Returns nullopt if the file does not exist:
  /// opening the file reports that error.
  [[nodiscard]] std::optional<ReferenceRefusal> refuse_file(const Origin& from, const std::string& path) const;

 private:
  std::vector<std::string> allowed_;  // canonical paths
};

/// Returns the reason why a document with this reach may not read from a host in the space `host`. Returns nullopt if
/// it may. `address` appears in the message and may be empty.
[[nodiscard]] std::optional<std::string> refuse_host(AddressSpace reach, AddressSpace host,
                                                     const std::string& address = {});

/// Converts a file name that another program wrote into a reference: percent-encoded, with slashes. Absolute paths
/// remain absolute.
[[nodiscard]] std::string reference_of_path(std::string_view path);

}  // namespace gs::net
