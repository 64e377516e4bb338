#pragma once

#include "net/control/control_server.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gs::app {

/// Channel for messages from and to control clients. Implemented by net::ControlServer.
class ControlChannel {
 public:
  virtual ~ControlChannel() = default;
  [[nodiscard]] virtual std::optional<net::ControlNews> next() = 0;
  virtual void send(std::uint64_t client, std::string message) = 0;
  [[nodiscard]] virtual bool is_behind(std::uint64_t client) const = 0;
};

}  // namespace gs::app
