#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gs::net {

/// Parts of a URI reference (RFC 3986 appendix B). The `has_` fields distinguish an empty part from a missing part.
struct Url {
  std::string scheme, authority, path, query, fragment;
  bool has_authority = false, has_query = false, has_fragment = false;

  [[nodiscard]] std::string text() const;
};

/// Host and port of an authority (RFC 3986 3.2). IPv6 addresses are without brackets. `port` is nullopt if the
/// authority has none.
struct HostAndPort {
  std::string host;
  std::optional<std::uint16_t> port;
};
/// Splits an authority. Returns nullopt if it has no host or an invalid port.
[[nodiscard]] std::optional<HostAndPort> host_and_port(std::string_view authority);

/// Splits any text into parts; never fails. Reads a one-letter scheme as a drive letter, which belongs to the path.
[[nodiscard]] Url parse_url(std::string_view text);

/// Reports whether a URL has this scheme, given in lower case without its colon. Schemes ignore case (RFC 3986 3.1).
[[nodiscard]] bool has_scheme(std::string_view url, std::string_view scheme);

/// Resolves a reference against a base URL (RFC 3986 5.2.2).
[[nodiscard]] Url resolve(const Url& base, const Url& reference);

/// Returns the file: URL of a path (absolute or relative to the current folder), percent-encoded.
[[nodiscard]] Url url_of_path(std::string_view path);
/// Returns the path of a file: URL, percent-decoded; empty for other schemes.
[[nodiscard]] std::string path_of_url(const Url& url);

/// Normalises an entry of a VRML `url` field. Turns backslashes into slashes, removes surrounding blanks and
/// percent-encodes inner blanks.
[[nodiscard]] std::string tidy_url(std::string_view text);

}  // namespace gs::net
