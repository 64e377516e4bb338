#pragma once

#include "net/control/control_connection.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gs::net {

/// Where clients come to.
struct ControlServerOptions {
  std::vector<std::string> paths;    // Unix sockets (mode 0600) that are made there, for ControlProtocol::lines
  std::vector<std::uint16_t> ports;  // of TCP on 127.0.0.1, for ControlProtocol::web_socket; 0: any free one
  ControlTerms terms;
  /// Called when all of them are there, before anybody can connect; what it says is wrong ends the start.
  std::function<std::optional<std::string>()> ready;
};

/// What has come from a client who is admitted.
struct ControlNews {
  std::uint64_t client = 0;  // a number that no other has
  bool left = false;         // it is gone, or sends nothing more: the last that is told of it
  std::string message;
};

/// Serves those who control this program, of this machine only, on a thread of its own; memory is bounded by the limits
/// of ControlTerms. What the messages mean, others know: they take them with `next`, client by client in turn, and
/// answer with `send`. A client whose messages are not taken is not read from.
class ControlServer {
 public:
  /// `wake` is called on the server's thread when `next` has something, or when `is_behind` has become false. The error
  /// names the path or port.
  [[nodiscard]] static std::variant<std::unique_ptr<ControlServer>, std::string> start(ControlServerOptions options,
                                                                                       std::function<void()> wake);
  /// Tells all clients to go, and waits for the thread, which takes milliseconds.
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  /// Those of the options, as they were found.
  [[nodiscard]] const std::vector<std::uint16_t>& ports() const;

  // Any thread.

  /// Nothing: no more has come.
  [[nodiscard]] std::optional<ControlNews> next();
  /// False: the client is gone, or has so much to read already that it is cut off.
  bool send(std::uint64_t client, std::string message);
  /// Whether it has much to read that it has not read yet: what need not be told can wait.
  [[nodiscard]] bool is_behind(std::uint64_t client) const;
  [[nodiscard]] std::size_t connections() const;

 private:
  struct State;
  explicit ControlServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::net
