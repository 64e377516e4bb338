#include "net/cells/udp.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <memory>
#include <system_error>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "net/base/reference_policy.h"

namespace gs::net {
namespace {

constexpr std::size_t kBuffer = 65536;
constexpr int kSystemBuffer = 1 << 20;
constexpr std::array<std::uint8_t, 12> kIpv4Mapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

bool is_ipv4(const Endpoint& endpoint) {
  return std::equal(kIpv4Mapped.begin(), kIpv4Mapped.end(), endpoint.address.begin());
}

socklen_t address_of(const Endpoint& endpoint, bool ipv6, sockaddr_storage& storage) {
  storage = {};
  if (ipv6) {
    auto& address = reinterpret_cast<sockaddr_in6&>(storage);
    address.sin6_family = AF_INET6;
    address.sin6_port = htons(endpoint.port);
    std::copy(endpoint.address.begin(), endpoint.address.end(), address.sin6_addr.s6_addr);
    return sizeof address;
  }
  if (!is_ipv4(endpoint)) return 0;
  auto& address = reinterpret_cast<sockaddr_in&>(storage);
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  std::memcpy(&address.sin_addr, endpoint.address.data() + kIpv4Mapped.size(), 4);
  return sizeof address;
}

std::optional<Endpoint> endpoint_of(const sockaddr* from) {
  const auto address = ip_address_of(from);
  if (!address) return std::nullopt;
  const bool six = from->sa_family == AF_INET6;
  return Endpoint{*address, ntohs(six ? reinterpret_cast<const sockaddr_in6*>(from)->sin6_port
                                      : reinterpret_cast<const sockaddr_in*>(from)->sin_port)};
}

std::string reason() { return std::generic_category().message(errno); }

/// Opens a socket of one family and binds it. Returns -1 and sets errno on failure.
int bound_socket(bool ipv6, std::uint16_t port, bool loopback) {
  const int made = ::socket(ipv6 ? AF_INET6 : AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (made < 0) return -1;
  const int off = 0;
  if (ipv6) (void)::setsockopt(made, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
  (void)::setsockopt(made, SOL_SOCKET, SO_RCVBUF, &kSystemBuffer, sizeof kSystemBuffer);
  (void)::setsockopt(made, SOL_SOCKET, SO_SNDBUF, &kSystemBuffer, sizeof kSystemBuffer);
  Endpoint any;
  if (!ipv6 || loopback) std::copy(kIpv4Mapped.begin(), kIpv4Mapped.end(), any.address.begin());
  if (loopback) any.address[12] = 127, any.address[15] = 1;
  any.port = port;
  sockaddr_storage storage;
  const socklen_t size = address_of(any, ipv6, storage);
  if (::bind(made, reinterpret_cast<const sockaddr*>(&storage), size) == 0) return made;
  const int code = errno;
  ::close(made);
  errno = code;
  return -1;
}

}  // namespace

std::variant<Endpoint, UdpError> find_host(const std::string& host, std::uint16_t port, AddressSpace reach,
                                           const AddressSpaceOf& space_of) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int code = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (code != 0) return UdpError{"cannot find the host " + host + ": " + ::gai_strerror(code)};
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, ::freeaddrinfo);
  std::optional<std::string> refused;
  for (const addrinfo* at = found; at; at = at->ai_next) {
    const auto endpoint = endpoint_of(at->ai_addr);
    if (!endpoint) continue;
    const auto why = refuse_host(reach, space_of(endpoint->address), address_text(endpoint->address));
    if (!why) return *endpoint;
    if (!refused) refused = why;
  }
  if (refused) return UdpError{"datagrams cannot be sent to " + host + ": " + *refused};
  return UdpError{"cannot find the host " + host + ": it has no IPv4 or IPv6 address"};
}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept { *this = std::move(other); }

UdpSocket& UdpSocket::operator=(UdpSocket&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(ipv6_, other.ipv6_);
  std::swap(port_, other.port_);
  std::swap(buffer_, other.buffer_);
  return *this;
}

UdpSocket::~UdpSocket() {
  if (socket_ >= 0) ::close(socket_);
}

std::variant<UdpSocket, UdpError> UdpSocket::open(std::uint16_t port, bool loopback) {
  UdpSocket result;
  result.ipv6_ = true;
  result.socket_ = bound_socket(true, port, loopback);
  if (result.socket_ < 0) {  // the system has no IPv6: use IPv4
    result.ipv6_ = false;
    result.socket_ = bound_socket(false, port, loopback);
  }
  if (result.socket_ < 0) return UdpError{"cannot use UDP port " + std::to_string(port) + ": " + reason()};
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (::getsockname(result.socket_, reinterpret_cast<sockaddr*>(&storage), &size) != 0)
    return UdpError{"cannot read the port of a UDP socket: " + reason()};
  if (const auto local = endpoint_of(reinterpret_cast<const sockaddr*>(&storage))) result.port_ = local->port;
  result.buffer_.resize(kBuffer);
  return result;
}

bool UdpSocket::send(const Endpoint& to, std::span<const std::byte> bytes) {
  sockaddr_storage storage;
  const socklen_t size = address_of(to, ipv6_, storage);
  if (size == 0) return false;
  return ::sendto(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&storage),
                  size) >= 0;
}

std::optional<std::span<const std::byte>> UdpSocket::receive(Endpoint& from) {
  // Skip a few errors that ICMP caused, such as refused datagrams.
  for (int i = 0; i < 16; ++i) {
    sockaddr_storage storage{};
    socklen_t size = sizeof storage;
    const ssize_t count =
        ::recvfrom(socket_, buffer_.data(), buffer_.size(), 0, reinterpret_cast<sockaddr*>(&storage), &size);
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return std::nullopt;
    if (count < 0) continue;
    const auto endpoint = endpoint_of(reinterpret_cast<const sockaddr*>(&storage));
    if (!endpoint) continue;
    from = *endpoint;
    return std::span<const std::byte>(buffer_).first(static_cast<std::size_t>(count));
  }
  return std::nullopt;
}

void UdpSocket::wait(std::chrono::microseconds most, bool for_room, int wake) const {
  std::array<pollfd, 2> waits{
      {{socket_, static_cast<short>(for_room ? POLLIN | POLLOUT : POLLIN), 0}, {wake, POLLIN, 0}}};
  most = std::max(most, std::chrono::microseconds(0));
  const std::timespec time{static_cast<std::time_t>(most.count() / 1'000'000),
                           static_cast<long>(most.count() % 1'000'000) * 1000};
  (void)::ppoll(waits.data(), wake >= 0 ? 2 : 1, &time, nullptr);
}

}  // namespace gs::net
