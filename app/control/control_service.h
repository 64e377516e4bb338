#pragma once

#include "app/control/control.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Addresses for clients, from the command line.
struct ControlPlaces {
  std::vector<std::string> paths;    // Unix sockets
  std::vector<std::uint16_t> ports;  // WebSockets on 127.0.0.1; 0 means any free port
  std::string token_file;            // if empty, the token is printed on standard error

  [[nodiscard]] bool any() const { return !paths.empty() || !ports.empty(); }
};

/// Control with its server.
class ControlService {
 public:
  /// Starts the server and prints the addresses on standard error. `wake` is that of net::ControlServer. The error
  /// names the address.
  [[nodiscard]] static std::variant<std::unique_ptr<ControlService>, std::string> start(const ControlPlaces& places,
                                                                                        std::function<void()> wake);
  ~ControlService();
  ControlService(const ControlService&) = delete;
  ControlService& operator=(const ControlService&) = delete;

  [[nodiscard]] Control& control();

 private:
  struct State;
  explicit ControlService(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::app
