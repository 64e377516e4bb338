#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

struct sockaddr;

namespace gs::net {

/// An address of IPv6; one of IPv4 is mapped into it (RFC 4291 2.5.5.2).
using IpAddress = std::array<std::uint8_t, 16>;

/// Who can be at the other end of an address, from the most private to the most open. A text may have others read from
/// its own space and from more open ones, as W3C's Local Network Access has it.
enum class AddressSpace : std::uint8_t {
  special,   // no host of ours or of the Internet: multicast, broadcast, documentation, reserved
  loopback,  // this machine
  local,     // its networks: RFC 1918, link-local, unique local, shared (RFC 6598)
  global     // the Internet
};

/// Whether a text of one space may have something read from another.
[[nodiscard]] constexpr bool reaches(AddressSpace from, AddressSpace to) { return to >= from; }
/// "this machine", "a local network", ... for messages.
[[nodiscard]] std::string_view name_of(AddressSpace space);

/// The space of an address, by IANA's registries of special-purpose addresses. An address of IPv4 that one of IPv6
/// carries (mapped, NAT64, 6to4) counts as itself.
[[nodiscard]] AddressSpace address_space_of(const IpAddress& address);
/// In place of address_space_of, for tests: a server on loopback stands for a public one.
using AddressSpaceOf = std::function<AddressSpace(const IpAddress&)>;

/// Nothing for other families than IPv4 and IPv6.
[[nodiscard]] std::optional<IpAddress> ip_address_of(const sockaddr* address);
/// "192.0.2.1" or "2001:db8::1"; nothing for any other text.
[[nodiscard]] std::optional<IpAddress> ip_address_of(const std::string& text);
[[nodiscard]] std::string address_text(const IpAddress& address);

/// A block of addresses: "10.0.0.0/8", "fe80::/10", or one address alone.
struct AddressBlock {
  IpAddress first{};
  unsigned bits = 128;

  [[nodiscard]] bool contains(const IpAddress& address) const;
};
[[nodiscard]] std::optional<AddressBlock> address_block_of(std::string_view text);

}  // namespace gs::net
