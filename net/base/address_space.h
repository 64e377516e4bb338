#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

struct sockaddr;

namespace gs::net {

/// IPv6 address; IPv4 addresses are mapped into it (RFC 4291 2.5.5.2).
using IpAddress = std::array<std::uint8_t, 16>;

/// Space of an address, from the most private to the most open. A document may read from its own space and from all
/// more open spaces, as in W3C's Local Network Access.
enum class AddressSpace : std::uint8_t {
  special,   // not a usable host: multicast, broadcast, documentation, reserved
  loopback,  // this machine
  local,  // local networks: RFC 1918, link-local, unique local, shared (RFC 6598)
  global     // the Internet
};

/// Reports whether a document from the space `from` may read from the space `to`.
[[nodiscard]] constexpr bool reaches(AddressSpace from, AddressSpace to) { return to >= from; }
/// Returns the name of a space for messages, such as "this machine" or "a local network".
[[nodiscard]] std::string_view name_of(AddressSpace space);

/// Returns the space of an address, by IANA's registries of special-purpose addresses. An IPv6 address that contains an
/// IPv4 address (mapped, NAT64, 6to4) has the space of the IPv4 address.
[[nodiscard]] AddressSpace address_space_of(const IpAddress& address);
/// Replaceable address_space_of(). A test can make a server on loopback count as public.
using AddressSpaceOf = std::function<AddressSpace(const IpAddress&)>;

/// Converts an address of the system. Returns nullopt for families other than IPv4 and IPv6.
[[nodiscard]] std::optional<IpAddress> ip_address_of(const sockaddr* address);
/// Parses an address such as "192.0.2.1" or "2001:db8::1". Returns nullopt for other text.
[[nodiscard]] std::optional<IpAddress> ip_address_of(const std::string& text);
[[nodiscard]] std::string address_text(const IpAddress& address);

/// Block of addresses such as "10.0.0.0/8" or "fe80::/10", or a single address.
struct AddressBlock {
  IpAddress first{};
  unsigned bits = 128;

  [[nodiscard]] bool contains(const IpAddress& address) const;
};
[[nodiscard]] std::optional<AddressBlock> address_block_of(std::string_view text);

}  // namespace gs::net
