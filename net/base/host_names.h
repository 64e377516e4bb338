#pragma once

#include "net/base/address_space.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::net {

/// Reports whether an address is in 127.0.0.0/8 or ::1.
[[nodiscard]] bool is_loopback(const IpAddress& address);

/// Returns the host of a Host field or of a URL's authority ("NAME", "NAME:PORT", "[ADDRESS]:PORT") in canonical
/// spelling: lower case, no trailing dot, addresses as in address_text(). Returns nullopt for other text.
[[nodiscard]] std::optional<std::string> host_of(std::string_view authority);

/// Names that a server answers to. A page of a foreign site can make its own name resolve to an address of this machine
/// (DNS rebinding). A browser then treats the page and the server as one origin; only the requested name differs. So a
/// server that listens on loopback only answers to these names: localhost, 127.0.0.1, [::1], its listening address, and
/// the given names. Other servers check names only if names are given. Ports are ignored: tunnels change them, and a
/// page cannot choose the name.
class HostNames {
 public:
  /// Sets the names. `bind` is an address or "*". `more` holds names as in a Host field, without ports.
  HostNames(const std::string& bind, const std::vector<std::string>& more);

  /// Reports whether a request with this Host field may be answered.
  [[nodiscard]] bool admits(std::string_view authority) const;
  /// Reports whether `authority` is one of this machine's own names (localhost, 127.0.0.1, [::1], the listening
  /// address).
  [[nodiscard]] bool is_own(std::string_view authority) const;

 private:
  std::vector<std::string> own_, more_;
  bool checked_ = false;
};

/// Returns the client of a request: the peer of the connection or, if the peer is one of `proxies`, the last address of
/// X-Forwarded-For that is not a proxy. Earlier addresses in that field can be forged.
[[nodiscard]] IpAddress client_of(const IpAddress& peer, std::string_view forwarded_for,
                                  const std::vector<AddressBlock>& proxies);
[[nodiscard]] bool is_one_of(const std::vector<AddressBlock>& blocks, const IpAddress& address);

}  // namespace gs::net
