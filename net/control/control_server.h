#pragma once

#include "base/noncopyable.h"
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
  std::vector<std::string> paths;  // paths of Unix sockets to create (mode 0600); clients use ControlProtocol::lines
  std::vector<std::uint16_t> ports;  // TCP ports on 127.0.0.1 (0: any free); clients use ControlProtocol::web_socket
  ControlTerms terms;
  /// Called when all sockets exist and no client can connect yet. If it returns an error, the start fails.
  std::function<std::optional<std::string>()> ready;
};

/// Message from an admitted client, or its departure.
struct ControlNews {
  std::uint64_t client = 0;  // unique id of the client
  bool left = false;  // last event of the client: disconnected, or no further messages
  std::string message;
};

/// Serves the clients that control this program, on its own thread. Accepts only clients on this machine. The owner
/// takes messages with `next`, which serves the clients in turn, and answers with `send`. If the owner takes no
/// messages, the server stops reading. ControlTerms bounds the memory.
class ControlServer : NonCopyable {
 public:
  /// Starts the server. Returns an error that names the path or port on failure. The server's thread calls `wake` when
  /// `next` has an event, or when `is_behind` becomes false.
  [[nodiscard]] static std::variant<std::unique_ptr<ControlServer>, std::string> start(ControlServerOptions options,
                                                                                       std::function<void()> wake);
  /// Disconnects all clients. Waits some milliseconds for the thread.
  ~ControlServer();

  /// Returns the TCP ports in the order of the options. A port 0 is replaced by the port that was chosen.
  [[nodiscard]] const std::vector<std::uint16_t>& ports() const;

  // All functions below are safe on any thread.

  /// Returns the next event, or nullopt if there is none.
  [[nodiscard]] std::optional<ControlNews> next();
  /// Queues a message. Returns false if the client is gone, or if it is disconnected because it has too much to read.
  bool send(std::uint64_t client, std::string message);
  /// Reports whether the client has many unread bytes. If so, messages that are not urgent should wait.
  [[nodiscard]] bool is_behind(std::uint64_t client) const;
  [[nodiscard]] std::size_t connections() const;

 private:
  struct State;
  explicit ControlServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::net
