#include "net/atm/atm_socket.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs::net;

TEST_CASE("opens a native ATM socket, or reports why it cannot", "[atm_socket]") {
  auto opened = AtmSocket::open(0, {0, 64}, 0);
  if (const auto* error = std::get_if<AtmError>(&opened)) {
    REQUIRE(error->message.find("ATM") != std::string::npos);
    if (!AtmSocket::available()) REQUIRE(error->message.find("cells over UDP") != std::string::npos);
  } else {
    REQUIRE(AtmSocket::available());
    REQUIRE_FALSE(std::get<AtmSocket>(opened).receive());
  }
  const auto strange = AtmSocket::open(-1, {0, 64}, 0);
  REQUIRE(std::holds_alternative<AtmError>(strange));
}

}  // namespace
