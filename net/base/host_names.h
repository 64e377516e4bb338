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

/// Names that a server answers to. Protects against DNS rebinding: a foreign site makes its own name resolve to an
/// address of this machine, and a browser then treats site and server as one origin. Only the requested name differs.
///
/// A server that listens on loopback answers to localhost, 127.0.0.1, [::1], its listening address and the given names.
/// Other servers check names only if names are given. Ports are ignored, because tunnels change them.
class HostNames {
 public:
  /// Sets the names. `bind` is the listening address or "*". `more` holds names as in a Host field, without ports.
  HostNames(const std::string& bind, const std::vector<std::string>& more);

  /// Reports whether a request with this Host field may be answered.
  [[nodiscard]] bool admits(std::string_view authority) const;
  /// Reports whether `authority` is a name of this machine: localhost, 127.0.0.1, [::1] or the listening address.
  [[nodiscard]] bool is_own(std::string_view authority) const;

 private:
  std::vector<std::string> own_, more_;
  bool checked_ = false;
};

/// Returns the client of a request. This is the peer of the connection, unless the peer is one of `proxies`. Then it is
/// the last address in X-Forwarded-For that is not a proxy; earlier addresses in that field can be forged.
[[nodiscard]] IpAddress client_of(const IpAddress& peer, std::string_view forwarded_for,
                                  const std::vector<AddressBlock>& proxies);
[[nodiscard]] bool is_one_of(const std::vector<AddressBlock>& blocks, const IpAddress& address);

}  // namespace gs::net
