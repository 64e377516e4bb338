#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "net/base/url.h"

namespace gs::net {

/// Transport of a scheme. `http` stands for all schemes that libcurl handles, FTP included.
enum class TransportKind { file, http, data, cells, memory };

/// Loader thread that handles a scheme: disks may block, networks may not.
enum class Lane { local, network };

/// Row of the table of URL schemes.
struct Scheme {
  std::string_view name;
  TransportKind transport;
  Lane lane;
  bool from_network;     // documents from a network and data: documents may refer to it
  bool redirect_target;  // a server may redirect to it
  bool cached;           // answers are stored on disk
  bool secure;           // the connection is encrypted and authenticated
  bool has_host;         // the number of transfers per host is limited
  bool needs_host;       // a URL without a host is invalid
  std::uint16_t port;    // default port; 0 means none
};

/// Returns the table of URL schemes.
[[nodiscard]] std::span<const Scheme> schemes();
/// Returns the row of a scheme, given in lower case, or null.
[[nodiscard]] const Scheme* find_scheme(std::string_view name);

/// Returns a URL in its canonical spelling (RFC 3986 6.2.2, 6.2.3): the host in lower case, no empty or default port.
/// URLs of schemes that need no host stay as they are. Returns nullopt if the scheme needs a host and the authority has
/// none, or has an invalid port. Two parsers of a canonical URL agree on its host.
[[nodiscard]] std::optional<Url> canonical_url(Url url);

/// Returns a URL for messages and logs: without user name, password and control characters, and shortened.
[[nodiscard]] std::string url_for_messages(std::string_view url);

}  // namespace gs::net
