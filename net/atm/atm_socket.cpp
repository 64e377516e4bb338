#include "net/atm/atm_socket.h"

#include "net/atm/aal5.h"

#include <algorithm>
#include <cerrno>
#include <limits>
#include <system_error>
#include <utility>

#if __has_include(<linux/atm.h>) && __has_include(<sys/socket.h>)
#include <linux/atm.h>
#include <sys/socket.h>
#include <unistd.h>
#if defined(AF_ATMPVC)
#define GHOSTSPACE_ATM 1
#endif
#endif

namespace gs::net {

AtmSocket::AtmSocket(AtmSocket&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

AtmSocket& AtmSocket::operator=(AtmSocket&& other) noexcept {
  std::swap(socket_, other.socket_);
  return *this;
}

#ifdef GHOSTSPACE_ATM

AtmSocket::~AtmSocket() {
  if (socket_ >= 0) ::close(socket_);
}

bool AtmSocket::available() {
  const int made = ::socket(AF_ATMPVC, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (made >= 0) ::close(made);
  return made >= 0;
}

std::variant<AtmSocket, AtmError> AtmSocket::open(int interface, Vc vc, std::uint32_t cells_per_second) {
  const std::string name =
      "ATM channel " + std::to_string(interface) + "." + std::to_string(vc.vpi) + "." + std::to_string(vc.vci);
  if (interface < 0 || interface > std::numeric_limits<short>::max())
    return AtmError{"there is no " + name + "; expected an interface from 0 to 32767"};
  AtmSocket result;
  result.socket_ = ::socket(AF_ATMPVC, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (result.socket_ < 0) {
    const int code = errno;
    if (code == EAFNOSUPPORT)
      return AtmError{"cannot open " + name + ": this kernel has no ATM (CONFIG_ATM); use cells over UDP"};
    return AtmError{"cannot open " + name + ": " + std::generic_category().message(code)};
  }
  atm_qos quality{};
  quality.aal = ATM_AAL5;
  quality.txtp.traffic_class = cells_per_second > 0 ? ATM_CBR : ATM_UBR;
  quality.rxtp.traffic_class = ATM_UBR;
  if (cells_per_second > 0)
    quality.txtp.min_pcr = quality.txtp.max_pcr =
        static_cast<int>(std::min<std::uint32_t>(cells_per_second, std::numeric_limits<int>::max()));
  quality.txtp.max_sdu = quality.rxtp.max_sdu = static_cast<int>(kMostPdu);
  sockaddr_atmpvc address{};
  address.sap_family = AF_ATMPVC;
  address.sap_addr.itf = static_cast<short>(interface);
  address.sap_addr.vpi = static_cast<short>(vc.vpi);
  address.sap_addr.vci = vc.vci;
  if (::setsockopt(result.socket_, SOL_ATM, SO_ATMQOS, &quality, sizeof quality) != 0 ||
      ::bind(result.socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return AtmError{"cannot open " + name + ": " + std::generic_category().message(errno)};
  return result;
}

bool AtmSocket::send(std::span<const std::byte> pdu) {
  return !pdu.empty() && pdu.size() <= kMostPdu && ::send(socket_, pdu.data(), pdu.size(), MSG_NOSIGNAL) >= 0;
}

std::optional<std::vector<std::byte>> AtmSocket::receive() {
  std::vector<std::byte> pdu(kMostPdu);
  const ssize_t count = ::recv(socket_, pdu.data(), pdu.size(), 0);
  if (count <= 0) return std::nullopt;
  pdu.resize(static_cast<std::size_t>(count));
  return pdu;
}

#else

AtmSocket::~AtmSocket() = default;
bool AtmSocket::available() { return false; }
std::variant<AtmSocket, AtmError> AtmSocket::open(int, Vc, std::uint32_t) {
  return AtmError{"this program was built without native ATM; use cells over UDP"};
}
bool AtmSocket::send(std::span<const std::byte>) { return false; }
std::optional<std::vector<std::byte>> AtmSocket::receive() { return std::nullopt; }

#endif

}  // namespace gs::net
