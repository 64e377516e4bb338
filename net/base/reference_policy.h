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
  /// Reports whether the origin is a file of an account that is reached by ssh.
  [[nodiscard]] bool is_ssh() const { return has_scheme(url, "ssh"); }
  /// Reports whether the document came from a server, and not from files that the user may read.
  [[nodiscard]] bool is_network() const { return !is_user() && !is_file() && !is_ssh(); }
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
  /// Allows documents of an account to refer to the folder of this ssh: URL, with its contents.
  void allow_ssh(const Url& document);

  /// Returns the reason why a document from `from` may not refer to `to`. Returns nullopt if it may. Reads the disk if
  /// `to` is a file.
  [[nodiscard]] std::optional<ReferenceRefusal> refuse(const Origin& from, const Url& to) const;
  /// Checks a reference to a file, after links in `path` are followed. Returns nullopt if the file does not exist:
  /// opening the file reports that error.
  [[nodiscard]] std::optional<ReferenceRefusal> refuse_file(const Origin& from, const std::string& path) const;
  /// Returns the folder in which an ssh: URL must lie after links are followed, as the path of a URL. Empty means that
  /// links may lead anywhere, because the user asks.
  [[nodiscard]] std::string ssh_folder(const Origin& from, const Url& to) const;

 private:
  [[nodiscard]] std::optional<ReferenceRefusal> refuse_ssh(const Origin& from, const Url& to) const;

  std::vector<std::string> allowed_;  // canonical paths
  std::vector<Url> allowed_ssh_;      // folders
};

/// Returns the reason why a document with this reach may not read from a host in the space `host`. Returns nullopt if
/// it may. `address` appears in the message and may be empty.
[[nodiscard]] std::optional<std::string> refuse_host(AddressSpace reach, AddressSpace host,
                                                     const std::string& address = {});

/// Converts a file name that another program wrote into a reference: percent-encoded, with slashes. Absolute paths
/// remain absolute.
[[nodiscard]] std::string reference_of_path(std::string_view path);

}  // namespace gs::net
