#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "net/base/address_space.h"
#include "net/base/url.h"

namespace gs::net {

/// Where a text came from: what its references are seen from, and what they may reach. What a data: URL holds has the
/// origin of the text that holds the URL.
struct Origin {
  std::string url;                             // of the text, after redirects; empty: the user, who may have anything
  AddressSpace space = AddressSpace::special;  // of the host that sent it; of no account for files

  [[nodiscard]] bool is_user() const { return url.empty(); }
  /// A file of this machine. Everything else that is not the user may have been written by anyone.
  [[nodiscard]] bool is_file() const { return has_scheme(url, "file"); }
  /// What decides: texts of one site may refer to the same. Of files there is one.
  [[nodiscard]] std::string site() const;
  /// The most private space in which a host may be that sends what this text refers to.
  [[nodiscard]] AddressSpace reach() const;

  friend bool operator==(const Origin&, const Origin&) = default;
};

/// Why a text may not refer to something.
struct ReferenceRefusal {
  std::string message;
  std::string folder;  // the user may allow this one, and with it the reference; empty: nothing allows it
};

/// Who may refer to what: the one rule for every reference of every format (docs/security.md). It is a value; any
/// thread, while nobody calls `allow`.
class ReferencePolicy {
 public:
  /// Files may refer to this file, or to all that lies in this folder and below it. Links are followed now. Nothing
  /// happens where there is none.
  void allow(const std::string& path);

  /// Why a text from `from` may not refer to `to`; nothing: it may. Looks at the disk where `to` is a file.
  [[nodiscard]] std::optional<ReferenceRefusal> refuse(const Origin& from, const Url& to) const;
  /// The same for a file by its path, links followed. Nothing where there is no such file: opening it says so.
  [[nodiscard]] std::optional<ReferenceRefusal> refuse_file(const Origin& from, const std::string& path) const;

 private:
  std::vector<std::string> allowed_;  // canonical
};

/// Why a text that reaches `reach` gets nothing from a host of this space; nothing: it may. `address`, for the message,
/// may be empty.
[[nodiscard]] std::optional<std::string> refuse_host(AddressSpace reach, AddressSpace host,
                                                     const std::string& address = {});

/// A reference that means a path as a program wrote it, in names of files rather than URLs: percent-encoded, with
/// slashes. An absolute path stays one.
[[nodiscard]] std::string reference_of_path(std::string_view path);

}  // namespace gs::net
