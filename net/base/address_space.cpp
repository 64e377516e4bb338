#include "net/base/address_space.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

namespace gs::net {
namespace {

constexpr std::size_t kMappedBytes = 12;
constexpr IpAddress kIpv4Prefix{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

bool is_ipv4(const IpAddress& address) {
  return std::equal(kIpv4Prefix.begin(), kIpv4Prefix.begin() + kMappedBytes, address.begin());
}

/// Returns the IPv4 address that an IPv6 address contains at byte offset `at`.
IpAddress carried(const IpAddress& address, std::size_t at) {
  IpAddress result = kIpv4Prefix;
  std::copy_n(address.begin() + static_cast<std::ptrdiff_t>(at), 4, result.begin() + kMappedBytes);
  return result;
}

/// Row of the table of special-purpose addresses (IANA's registries). The first row with the address applies. The last
/// rows cover the Internet.
struct SpaceRow {
  std::string_view block;
  AddressSpace space;
};
constexpr SpaceRow kSpaces[] = {
    {"0.0.0.0/8", AddressSpace::loopback},      // "this host": connects to this machine
    {"10.0.0.0/8", AddressSpace::local},        // RFC 1918
    {"100.64.0.0/10", AddressSpace::local},     // carrier-grade NAT, RFC 6598
    {"127.0.0.0/8", AddressSpace::loopback},    //
    {"169.254.0.0/16", AddressSpace::local},  // link-local; includes the metadata services of cloud providers
    {"172.16.0.0/12", AddressSpace::local},     // RFC 1918
    {"192.0.0.0/24", AddressSpace::special},    // protocol assignments
    {"192.0.2.0/24", AddressSpace::special},    // documentation
    {"192.88.99.0/24", AddressSpace::special},  // 6to4 relays, deprecated
    {"192.168.0.0/16", AddressSpace::local},    // RFC 1918
    {"198.18.0.0/15", AddressSpace::local},     // benchmarks
    {"198.51.100.0/24", AddressSpace::special},
    {"203.0.113.0/24", AddressSpace::special},
    {"224.0.0.0/3", AddressSpace::special},  // multicast, reserved, broadcast
    {"0.0.0.0/0", AddressSpace::global},
    {"::/127", AddressSpace::loopback},  // unspecified address, which connects to this machine; ::1
    {"64:ff9b:1::/48", AddressSpace::local},   // local-use NAT64
    {"2001::/23", AddressSpace::special},      // protocol assignments; Teredo
    {"2001:db8::/32", AddressSpace::special},  // documentation
    {"3fff::/20", AddressSpace::special},      // documentation
    {"2000::/3", AddressSpace::global},        // all allocated addresses
    {"fc00::/7", AddressSpace::local},         // unique local
    {"fe80::/9", AddressSpace::local},         // link-local and site-local
    {"::/0", AddressSpace::special},
};

struct SpaceBlock {
  AddressBlock block;
  AddressSpace space;
};

const std::vector<SpaceBlock>& space_blocks() {
  static const std::vector<SpaceBlock> all = [] {
    std::vector<SpaceBlock> made;
    for (const SpaceRow& row : kSpaces)
      if (const auto block = address_block_of(row.block)) made.push_back({*block, row.space});
    return made;
  }();
  return all;
}

}  // namespace

std::string_view name_of(AddressSpace space) {
  static constexpr std::string_view kNames[] = {"no single host", "this machine", "a local network", "the Internet"};
  return kNames[static_cast<std::size_t>(space)];
}

bool AddressBlock::contains(const IpAddress& address) const {
  const auto whole = static_cast<std::ptrdiff_t>(bits / 8);
  if (!std::equal(first.begin(), first.begin() + whole, address.begin())) return false;
  const unsigned rest = bits % 8;
  if (rest == 0) return true;
  const auto at = static_cast<std::size_t>(whole);
  return ((first[at] ^ address[at]) >> (8 - rest)) == 0;
}

std::optional<AddressBlock> address_block_of(std::string_view text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto address = ip_address_of(std::string(text.substr(0, slash)));
  if (!address) return std::nullopt;
  AddressBlock block{*address, 128};
  if (slash == text.size()) return block;
  const unsigned before = text.substr(0, slash).find(':') == std::string_view::npos ? kMappedBytes * 8 : 0;
  const std::string_view number = text.substr(slash + 1);
  unsigned bits = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), bits);
  if (error != std::errc() || end != number.data() + number.size() || bits > 128 - before) return std::nullopt;
  block.bits = before + bits;
  return block;
}

AddressSpace address_space_of(const IpAddress& address) {
  static const AddressBlock nat64 = *address_block_of("64:ff9b::/96"), six_to_four = *address_block_of("2002::/16");
  if (nat64.contains(address)) return address_space_of(carried(address, kMappedBytes));
  if (six_to_four.contains(address)) return address_space_of(carried(address, 2));
  for (const SpaceBlock& row : space_blocks())
    if (row.block.contains(address)) return row.space;
  return AddressSpace::special;
}

std::optional<IpAddress> ip_address_of(const sockaddr* address) {
  IpAddress result = kIpv4Prefix;
  if (address->sa_family == AF_INET6) {
    std::copy_n(reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr.s6_addr, result.size(), result.begin());
    return result;
  }
  if (address->sa_family != AF_INET) return std::nullopt;
  const auto* four = reinterpret_cast<const std::uint8_t*>(&reinterpret_cast<const sockaddr_in*>(address)->sin_addr);
  std::copy_n(four, 4, result.begin() + kMappedBytes);
  return result;
}

std::optional<IpAddress> ip_address_of(const std::string& text) {
  IpAddress result = kIpv4Prefix;
  if (::inet_pton(AF_INET, text.c_str(), result.data() + kMappedBytes) == 1) return result;
  if (::inet_pton(AF_INET6, text.c_str(), result.data()) == 1) return result;
  return std::nullopt;
}

std::string address_text(const IpAddress& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const bool four = is_ipv4(address);
  (void)::inet_ntop(four ? AF_INET : AF_INET6, address.data() + (four ? kMappedBytes : 0), text.data(),
                    static_cast<socklen_t>(text.size()));
  return text.data();
}

}  // namespace gs::net
