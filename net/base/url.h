#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gs::net {

/// A URI reference cut into its parts (RFC 3986 appendix B); `has_*` tells an empty part from none.
struct Url {
  std::string scheme, authority, path, query, fragment;
  bool has_authority = false, has_query = false, has_fragment = false;

  [[nodiscard]] std::string text() const;
};

/// Where an authority leads, RFC 3986 3.2: a name or address (an IPv6 one without its brackets), and the port if it
/// names one that can be.
struct HostAndPort {
  std::string host;
  std::optional<std::uint16_t> port;
};
/// Nothing for an authority without host or with a port that is none.
[[nodiscard]] std::optional<HostAndPort> host_and_port(std::string_view authority);

/// Cuts any text into parts; never fails. A one-letter scheme is taken for a drive letter and is a path.
[[nodiscard]] Url parse_url(std::string_view text);

/// Reports whether a URL has this scheme, given in lower case without its colon. Schemes ignore case (RFC 3986 3.1).
[[nodiscard]] bool has_scheme(std::string_view url, std::string_view scheme);

/// `reference` as seen from `base` (RFC 3986 5.2.2).
[[nodiscard]] Url resolve(const Url& base, const Url& reference);

/// A file: URL of a path (absolute or from the current folder), percent-encoded.
[[nodiscard]] Url url_of_path(std::string_view path);
/// The path of a file: URL, percent-decoded; empty for any other scheme.
[[nodiscard]] std::string path_of_url(const Url& url);

/// A url of a VRML file as its author meant it: backslashes become slashes, surrounding blanks go,
/// blanks inside are percent-encoded.
[[nodiscard]] std::string tidy_url(std::string_view text);

}  // namespace gs::net
