#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "net/base/url.h"

namespace gs::net {

/// Transport of a scheme. `http` includes all schemes that libcurl handles, also FTP and HTTP
/// over ssh.
enum class TransportKind { file, http, data, cells, memory };

/// Loader thread that handles a scheme. Reads from disks may block; network transfers may not.
enum class Lane { local, network };

/// Row of the table of URL schemes.
struct Scheme {
  std::string_view name;
  TransportKind transport;
  Lane lane;
  bool from_network;  // documents from a network or a data: URL may use the scheme
  bool redirect_target;  // a server may redirect to the scheme
  bool cached;  // received answers are stored on disk
  bool buckets;  // folders may be prefixes of keys in buckets of an object store
  bool secure;           // the connection is encrypted and authenticated
  bool has_host;  // transfers per host are limited
  bool needs_host;       // a URL without a host is invalid
  std::uint16_t port;    // default port; 0 means none
};

/// Returns the table of URL schemes.
[[nodiscard]] std::span<const Scheme> schemes();
/// Returns the row of a scheme, given in lower case. Returns null if the scheme is not in the table.
[[nodiscard]] const Scheme* find_scheme(std::string_view name);

/// Returns a URL in its canonical spelling (RFC 3986 6.2.2, 6.2.3): the host in lower case, no empty or default port.
/// Leaves URLs unchanged if their scheme needs no host. Returns nullopt if a required host is missing or the port is
/// invalid. All parsers of a canonical URL find the same host.
[[nodiscard]] std::optional<Url> canonical_url(Url url);

/// Returns a shortened URL for messages and logs, without user name, password, signature and control characters.
[[nodiscard]] std::string url_for_messages(std::string_view url);

}  // namespace gs::net
