#pragma once

#include "net/atm/cells.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::net {

/// Reason why an ATM socket is not available.
struct AtmError {
  std::string message;
};

/// Permanent virtual channel of a native ATM interface with AAL5 (Linux: AF_ATMPVC). Sends and receives whole PDUs; the
/// adapter handles cells, checksums and order. Never blocks. Movable. One thread. `open` returns an error on systems
/// without ATM support.
class AtmSocket {
 public:
  AtmSocket() = default;
  AtmSocket(AtmSocket&& other) noexcept;
  AtmSocket& operator=(AtmSocket&& other) noexcept;
  AtmSocket(const AtmSocket&) = delete;
  AtmSocket& operator=(const AtmSocket&) = delete;
  ~AtmSocket();

  /// Opens channel `vc` of an interface. `cells_per_second` limits sending; 0 means line speed.
  [[nodiscard]] static std::variant<AtmSocket, AtmError> open(int interface, Vc vc, std::uint32_t cells_per_second);
  /// Reports whether the kernel supports such sockets.
  [[nodiscard]] static bool available();
  /// Sends a PDU. Returns false if the queue is full or the PDU is longer than 65535 bytes.
  bool send(std::span<const std::byte> pdu);
  /// Returns the user data of the next PDU, or nullopt if none is waiting.
  [[nodiscard]] std::optional<std::vector<std::byte>> receive();

 private:
  int socket_ = -1;
};

}  // namespace gs::net
