#include "net/base/address_space.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>

namespace {

using namespace gs::net;

AddressSpace space(const std::string& text) {
  const auto address = ip_address_of(text);
  REQUIRE(address);
  return address_space_of(*address);
}

TEST_CASE("classifies addresses as loopback, local, global or special") {
  constexpr std::pair<const char*, AddressSpace> kRows[] = {
      {"127.0.0.1", AddressSpace::loopback},
      {"127.255.255.255", AddressSpace::loopback},
      {"0.0.0.0", AddressSpace::loopback},
      {"0.1.2.3", AddressSpace::loopback},
      {"::1", AddressSpace::loopback},
      {"::", AddressSpace::loopback},
      {"10.0.0.0", AddressSpace::local},
      {"10.255.255.255", AddressSpace::local},
      {"100.63.255.255", AddressSpace::global},
      {"100.64.0.0", AddressSpace::local},
      {"100.127.255.255", AddressSpace::local},
      {"100.128.0.0", AddressSpace::global},
      {"169.254.169.254", AddressSpace::local},
      {"172.15.255.255", AddressSpace::global},
      {"172.16.0.0", AddressSpace::local},
      {"172.31.255.255", AddressSpace::local},
      {"172.32.0.0", AddressSpace::global},
      {"192.168.1.1", AddressSpace::local},
      {"192.169.0.0", AddressSpace::global},
      {"198.17.255.255", AddressSpace::global},
      {"198.19.0.1", AddressSpace::local},
      {"198.20.0.0", AddressSpace::global},
      {"192.0.2.1", AddressSpace::special},
      {"223.255.255.255", AddressSpace::global},
      {"224.0.0.1", AddressSpace::special},
      {"239.255.255.255", AddressSpace::special},
      {"240.0.0.1", AddressSpace::special},
      {"255.255.255.255", AddressSpace::special},
      {"1.1.1.1", AddressSpace::global},
      {"2606:4700::1", AddressSpace::global},
      {"fc00::1", AddressSpace::local},
      {"fdff::1", AddressSpace::local},
      {"fe80::1", AddressSpace::local},
      {"fec0::1", AddressSpace::local},
      {"ff02::1", AddressSpace::special},
      {"2001:db8::1", AddressSpace::special},
      {"2001::1", AddressSpace::special},
      {"4000::1", AddressSpace::special},
      {"::2", AddressSpace::special},
      // IPv4 addresses inside IPv6: mapped, NAT64, 6to4, compatible.
      {"::ffff:127.0.0.1", AddressSpace::loopback},
      {"::ffff:10.1.2.3", AddressSpace::local},
      {"::ffff:8.8.8.8", AddressSpace::global},
      {"64:ff9b::127.0.0.1", AddressSpace::loopback},
      {"64:ff9b::192.168.0.1", AddressSpace::local},
      {"64:ff9b::8.8.8.8", AddressSpace::global},
      {"64:ff9b:1::8.8.8.8", AddressSpace::local},
      {"2002:7f00:1::1", AddressSpace::loopback},
      {"2002:a00:1::1", AddressSpace::local},
      {"2002:808:808::1", AddressSpace::global},
      {"::127.0.0.1", AddressSpace::special},
  };
  for (const auto& [text, expected] : kRows) {
    INFO(text);
    CHECK(space(text) == expected);
  }
}

TEST_CASE("lets a text reach its own address space and more public ones") {
  constexpr AddressSpace kAll[] = {AddressSpace::special, AddressSpace::loopback, AddressSpace::local,
                                   AddressSpace::global};
  for (int from = 0; from < 4; ++from)
    for (int to = 0; to < 4; ++to) CHECK(reaches(kAll[from], kAll[to]) == (to >= from));
}

TEST_CASE("parses addresses from texts and sockets") {
  CHECK(address_text(*ip_address_of("::ffff:1.2.3.4")) == "1.2.3.4");
  CHECK(address_text(*ip_address_of("2001:DB8:0::1")) == "2001:db8::1");
  for (const char* bad : {"", "localhost", "1.2.3", "1.2.3.4.5", "1.2.3.256", "0x7f.1", "::g", "[::1]", "1.2.3.4/8"})
    CHECK_FALSE(ip_address_of(std::string(bad)));
  sockaddr_in four{};
  four.sin_family = AF_INET;
  four.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  CHECK(ip_address_of(reinterpret_cast<const sockaddr*>(&four)) == ip_address_of("127.0.0.1"));
  sockaddr_in6 six{};
  six.sin6_family = AF_INET6;
  six.sin6_addr = in6addr_loopback;
  CHECK(ip_address_of(reinterpret_cast<const sockaddr*>(&six)) == ip_address_of("::1"));
  sockaddr_un other{};
  other.sun_family = AF_UNIX;
  CHECK_FALSE(ip_address_of(reinterpret_cast<const sockaddr*>(&other)));
}

TEST_CASE("matches addresses with blocks of addresses") {
  const auto contains = [](const char* block, const char* address) {
    const auto found = address_block_of(block);
    REQUIRE(found);
    return found->contains(*ip_address_of(std::string(address)));
  };
  CHECK(contains("10.0.0.0/8", "10.255.0.1"));
  CHECK_FALSE(contains("10.0.0.0/8", "11.0.0.1"));
  CHECK(contains("192.0.2.7", "192.0.2.7"));
  CHECK_FALSE(contains("192.0.2.7", "192.0.2.6"));
  CHECK(contains("192.0.2.128/25", "192.0.2.200"));
  CHECK_FALSE(contains("192.0.2.128/25", "192.0.2.127"));
  CHECK(contains("fe80::/10", "febf::1"));
  CHECK_FALSE(contains("fe80::/10", "fec0::1"));
  CHECK(contains("::/0", "1.2.3.4"));
  for (const char* bad : {"", "/8", "10.0.0.0/33", "::/129", "10.0.0.0/", "10.0.0.0/x", "10.0.0.0/8 ", "a/8"})
    CHECK_FALSE(address_block_of(bad));
}

}  // namespace
