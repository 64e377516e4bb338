#pragma once

#include "app/control/control.h"
#include "base/noncopyable.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Addresses on which clients may connect, from the command line.
struct ControlPlaces {
  std::vector<std::string> paths;  // paths of Unix sockets
  std::vector<std::uint16_t> ports;  // ports of WebSockets on 127.0.0.1; 0 means any free port
  std::string token_file;  // file for the token; if empty, the token is printed on standard error

  [[nodiscard]] bool any() const { return !paths.empty() || !ports.empty(); }
};

/// Control together with its network server.
class ControlService : NonCopyable {
 public:
  /// Starts the server and prints its addresses on standard error. `wake` is passed to net::ControlServer. Returns an
  /// error that contains the address.
  [[nodiscard]] static std::variant<std::unique_ptr<ControlService>, std::string> start(const ControlPlaces& places,
                                                                                        std::function<void()> wake);
  ~ControlService();

  [[nodiscard]] Control& control();

 private:
  struct State;
  explicit ControlService(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::app
