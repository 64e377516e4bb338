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

/// Addresses and settings of a server.
struct ControlServerOptions {
  std::vector<std::string> paths;    // paths of Unix sockets to create (mode 0600), for ControlProtocol::lines
  std::vector<std::uint16_t> ports;  // TCP ports on 127.0.0.1, for ControlProtocol::web_socket; 0 means any free port
  ControlTerms terms;
  /// Called when all sockets exist, before any client can connect. A returned error ends the start.
  std::function<std::optional<std::string>()> ready;
};

/// Message or departure of an admitted client.
struct ControlNews {
  std::uint64_t client = 0;  // unique number
  bool left = false;         // the client is gone or sends nothing more; its last event
  std::string message;
};

/// Serves the clients that control this program, from this machine only, on its own thread. ControlTerms bounds the
/// memory. The owner interprets the messages: it takes them with `next`, client by client in turn, and answers with
/// `send`. The server does not read from a client while its messages are not taken.
class ControlServer {
 public:
  /// Starts the server, or returns an error that names the path or port. The server's thread calls `wake` when `next`
  /// has an event, or when `is_behind` becomes false.
  [[nodiscard]] static std::variant<std::unique_ptr<ControlServer>, std::string> start(ControlServerOptions options,
                                                                                       std::function<void()> wake);
  /// Disconnects all clients and waits some milliseconds until the thread ends.
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  /// Returns the ports in the order of the options, with the numbers in use.
  [[nodiscard]] const std::vector<std::uint16_t>& ports() const;

  // Any thread.

  /// Returns the next event, or nullopt if there is none.
  [[nodiscard]] std::optional<ControlNews> next();
  /// Queues a message. Returns false if the client is gone, or is disconnected because it has too much to read.
  bool send(std::uint64_t client, std::string message);
  /// Reports whether the client has much to read; messages that are not urgent should wait.
  [[nodiscard]] bool is_behind(std::uint64_t client) const;
  [[nodiscard]] std::size_t connections() const;

 private:
  struct State;
  explicit ControlServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::net
