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

/// Why there is no ATM socket.
struct AtmError {
  std::string message;
};

/// A permanent virtual channel of a native ATM interface, AAL5 (Linux:
/// AF_ATMPVC): whole PDUs in, whole PDUs out; cells, checksums and order are
/// the adapter's. Never blocks. Movable; one thread. On systems whose kernel or
/// headers know no ATM `open` says so.
class AtmSocket {
 public:
  AtmSocket() = default;
  AtmSocket(AtmSocket&& other) noexcept;
  AtmSocket& operator=(AtmSocket&& other) noexcept;
  AtmSocket(const AtmSocket&) = delete;
  AtmSocket& operator=(const AtmSocket&) = delete;
  ~AtmSocket();

  /// Channel `vc` of an interface; `cells_per_second` for sending, 0: as fast
  /// as the line.
  [[nodiscard]] static std::variant<AtmSocket, AtmError> open(int interface, Vc vc, std::uint32_t cells_per_second);
  /// Whether the kernel has such sockets at all.
  [[nodiscard]] static bool available();
  /// False when there is no room now, or the PDU is longer than 65535 bytes.
  bool send(std::span<const std::byte> pdu);
  /// The user data of the next PDU; nothing when there is none now.
  [[nodiscard]] std::optional<std::vector<std::byte>> receive();

 private:
  int socket_ = -1;
};

}  // namespace gs::net
