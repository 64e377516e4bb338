#pragma once

#include "net/base/address_space.h"
#include "net/cells/cell_contract.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::net {

/// Why a socket could not be had or used.
struct UdpError {
  std::string message;
};

/// "192.0.2.1:6635" or "[2001:db8::1]:6635".
[[nodiscard]] std::string endpoint_text(const Endpoint& endpoint);
/// The first address of a host, by its name or number, that a text of this
/// reach may have datagrams sent to. Blocks as long as name servers do.
[[nodiscard]] std::variant<Endpoint, UdpError> find_host(const std::string& host, std::uint16_t port,
                                                         AddressSpace reach = AddressSpace::special,
                                                         const AddressSpaceOf& space_of = address_space_of);

/// A socket of UDP, IPv6 and IPv4 alike where the system has both. Never blocks
/// but in `wait`. Movable; one thread.
class UdpSocket {
 public:
  UdpSocket() = default;
  UdpSocket(UdpSocket&& other) noexcept;
  UdpSocket& operator=(UdpSocket&& other) noexcept;
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  ~UdpSocket();

  /// Bound to a port (0: any free one) of every address, or only of this
  /// machine's own (`loopback`).
  [[nodiscard]] static std::variant<UdpSocket, UdpError> open(std::uint16_t port, bool loopback);
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// False when the system has no room for it now, or no way there.
  bool send(const Endpoint& to, std::span<const std::byte> bytes);
  /// The next datagram that came; longer ones are cut at 64 KiB. Nothing when
  /// there is none now.
  [[nodiscard]] std::optional<std::span<const std::byte>> receive(Endpoint& from);
  /// Until something came, or room is there for sending where that is asked, or
  /// `wake` (a descriptor; -1: none) can be read, at most so long.
  void wait(std::chrono::microseconds most, bool for_room, int wake) const;

 private:
  int socket_ = -1;
  bool ipv6_ = false;
  std::uint16_t port_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace gs::net
