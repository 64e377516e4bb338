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

/// Reason why a socket cannot be opened or used.
struct UdpError {
  std::string message;
};

/// Returns an address of a host to which a document with this reach may send datagrams. `host` is a name or an address.
/// Blocks while name servers are asked.
[[nodiscard]] std::variant<Endpoint, UdpError> find_host(const std::string& host, std::uint16_t port,
                                                         AddressSpace reach = AddressSpace::special,
                                                         const AddressSpaceOf& space_of = address_space_of);

/// UDP socket for IPv6 and IPv4, as far as the system has both. Only `wait` blocks. Movable. One thread.
class UdpSocket {
 public:
  UdpSocket() = default;
  UdpSocket(UdpSocket&& other) noexcept;
  UdpSocket& operator=(UdpSocket&& other) noexcept;
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  ~UdpSocket();

  /// Opens a socket. `port` 0 means any free port. `loopback` accepts datagrams only from this machine.
  [[nodiscard]] static std::variant<UdpSocket, UdpError> open(std::uint16_t port, bool loopback);
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Sends a datagram. Returns false if the system has no buffer space now, or no route.
  bool send(const Endpoint& to, std::span<const std::byte> bytes);
  /// Returns the next received datagram, shortened to 64 KiB. Returns nullopt if none is waiting.
  [[nodiscard]] std::optional<std::span<const std::byte>> receive(Endpoint& from);
  /// Waits at most `most` for a received datagram, for the descriptor `wake` to be readable, or for space to send.
  /// Without `for_room`, does not wait for space. `wake` -1 means no descriptor.
  void wait(std::chrono::microseconds most, bool for_room, int wake) const;

 private:
  int socket_ = -1;
  bool ipv6_ = false;
  std::uint16_t port_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace gs::net
