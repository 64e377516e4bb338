#pragma once

#include "app/control/control.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Where clients come to, as the command line says it.
struct ControlPlaces {
  std::vector<std::string> paths;    // Unix sockets
  std::vector<std::uint16_t> ports;  // WebSockets on 127.0.0.1; 0: any free port
  std::string token_file;            // empty: the token is told on standard error

  [[nodiscard]] bool any() const { return !paths.empty() || !ports.empty(); }
};

/// A Control, and the server whose clients it serves.
class ControlService {
 public:
  /// Tells on standard error where clients may come to. `wake`: as of net::ControlServer. The error names the place.
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
