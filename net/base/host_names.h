#pragma once

#include "net/base/address_space.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::net {

/// 127.0.0.0/8 and ::1.
[[nodiscard]] bool is_loopback(const IpAddress& address);

/// The host of a Host field or of a URL's authority ("NAME", "NAME:PORT", "[ADDRESS]:PORT"), in one spelling: lower
/// case, without a point at its end, addresses as address_text has them. Nothing for what is none of these.
[[nodiscard]] std::optional<std::string> host_of(std::string_view authority);

/// The names by which a server may be called. A page of a foreign site can have its own name resolve to an address of
/// this machine (DNS rebinding) and is then, to a browser, of one origin with the server; only the name that is asked
/// for gives it away. So where a server listens on loopback alone it answers for these names only: localhost,
/// 127.0.0.1, [::1], the address that it listens at, and what is given. Elsewhere it does so when names are given.
/// Ports do not matter: they are others behind a tunnel, and no page can choose the name.
class HostNames {
 public:
  /// `bind`: an address, or "*". `more`: as in a Host field, without port.
  HostNames(const std::string& bind, const std::vector<std::string>& more);

  /// Whether a request may be answered that has this Host field.
  [[nodiscard]] bool admits(std::string_view authority) const;
  /// Whether it is one of this machine's own names for itself (localhost, 127.0.0.1, [::1], the address above).
  [[nodiscard]] bool is_own(std::string_view authority) const;

 private:
  std::vector<std::string> own_, more_;
  bool checked_ = false;
};

/// Whose request it is: the peer of the connection, or where that is one of `proxies`, the last of the addresses of
/// X-Forwarded-For that is none of them. What stands before that anyone may have written.
[[nodiscard]] IpAddress client_of(const IpAddress& peer, std::string_view forwarded_for,
                                  const std::vector<AddressBlock>& proxies);
[[nodiscard]] bool is_one_of(const std::vector<AddressBlock>& blocks, const IpAddress& address);

}  // namespace gs::net
