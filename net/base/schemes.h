#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "net/base/url.h"

namespace gs::net {

/// Who carries the bytes of a scheme. `http` carries all that libcurl is asked for, files by FTP too.
enum class TransportKind { file, http, data, cells, memory };

/// Which of the loader's threads a scheme lives on: disks may block, networks may not.
enum class Lane { local, network };

/// All that the loader knows of a URL scheme.
struct Scheme {
  std::string_view name;
  TransportKind transport;
  Lane lane;
  bool from_network;     // documents that came over a network (and data: documents) may refer to it
  bool redirect_target;  // a server may redirect to it
  bool cached;           // answers are kept on disk
  bool secure;           // nobody on the way can read or change what comes
  bool has_host;         // the number of transfers of one host is bounded
  bool needs_host;       // a URL without a host is invalid
  std::uint16_t port;    // default port; 0 means none
};

/// The table of URL schemes, the only one.
[[nodiscard]] std::span<const Scheme> schemes();
/// The row of a scheme in lower case, or nothing.
[[nodiscard]] const Scheme* find_scheme(std::string_view name);

/// Returns a URL in its canonical spelling (RFC 3986 6.2.2, 6.2.3): the host in lower case, no empty or default port.
/// URLs of schemes that need no host stay as they are. Returns nullopt if the scheme needs a host and the authority has
/// none, or has an invalid port. Two parsers of a canonical URL agree on its host.
[[nodiscard]] std::optional<Url> canonical_url(Url url);

/// A URL as it may stand in messages and logs: without user name and password, without control characters, shortened.
[[nodiscard]] std::string url_for_messages(std::string_view url);

}  // namespace gs::net
