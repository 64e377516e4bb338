#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "net/base/address_space.h"
#include "net/base/url.h"

namespace gs::net {

/// Source of a document. References are resolved against it, and it decides which of them are allowed. The content of a
/// data: URL has the origin of the document that holds the URL.
struct Origin {
  // URL of the document after redirects; empty means the user, for whom all is allowed
  std::string url;
  AddressSpace space = AddressSpace::special;  // space of the host that sent it; not used for files

  [[nodiscard]] bool is_user() const { return url.empty(); }
  /// Reports whether the origin is a file of this machine. All other origins except the user are untrusted.
  [[nodiscard]] bool is_file() const { return has_scheme(url, "file"); }
  /// Returns the site of the origin; documents of one site may refer to that site. All files are one site.
  [[nodiscard]] std::string site() const;
  /// Returns the most private space to which this document may refer.
  [[nodiscard]] AddressSpace reach() const;

  friend bool operator==(const Origin&, const Origin&) = default;
};

/// Reason why a document may not refer to something.
struct ReferenceRefusal {
  std::string message;
  std::string folder;  // the user may allow this folder and thereby the reference; empty if nothing allows it
};

/// Rule for all references of all formats (docs/security.md). Copyable. Any thread, unless `allow` is being called.
class ReferencePolicy {
 public:
  /// Allows files to refer to this file, or to everything below this folder. Follows links now. Does nothing if the
  /// path does not exist.
  void allow(const std::string& path);

  /// Returns the reason why a document from `from` may not refer to `to`, or nullopt if it may. Reads the disk if `to`
  /// is a file.
  [[nodiscard]] std::optional<ReferenceRefusal> refuse(const Origin& from, const Url& to) const;
  /// Checks a reference to a file by its path, with links followed. Returns nullopt if the file does not exist; opening
  /// it then reports the error.
  [[nodiscard]] std::optional<ReferenceRefusal> refuse_file(const Origin& from, const std::string& path) const;

 private:
  std::vector<std::string> allowed_;  // canonical
};

/// Returns the reason why a document with this reach may not read from a host in this space, or nullopt if it may.
/// `address` appears in the message and may be empty.
[[nodiscard]] std::optional<std::string> refuse_host(AddressSpace reach, AddressSpace host,
                                                     const std::string& address = {});

/// Makes a reference from a path that a program wrote as a file name: percent-encoded, with slashes. Absolute paths
/// stay absolute.
[[nodiscard]] std::string reference_of_path(std::string_view path);

}  // namespace gs::net
