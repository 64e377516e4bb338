#pragma once

#include "net/base/host_names.h"
#include "net/control/websocket_frames.h"
#include "net/limits/token_bucket.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::net {

/// Framing of messages.
enum class ControlProtocol : std::uint8_t {
  lines,       // one message per line
  web_socket,  // RFC 6455
};

struct ControlLimits {
  std::size_t message_bytes = std::size_t{4} << 20;  // maximum bytes of one message from an admitted client
  // Bytes of a client's messages that nobody has taken; beyond it, no more are read.
  std::size_t waiting_bytes = std::size_t{8} << 20;
  std::size_t waiting_messages = 4096;  // number of such messages
  // Bytes that a client has not read; beyond it, it is disconnected.
  std::size_t outgoing_bytes = std::size_t{16} << 20;
  std::size_t clients = 16;  // admitted clients
  // Clients that are not admitted yet; beyond it, the oldest is disconnected.
  std::size_t strangers = 64;
  Instant admission{10'000'000};  // maximum time until admission
};

/// Settings that all connections share.
struct ControlTerms {
  std::string token;
  ControlLimits limits;
  /// Returns the last message to a client that uses lines and is disconnected. A WebSocket gets a close frame instead.
  std::function<std::string(const std::string& why)> farewell;
};

/// State machine of one connection, without its socket: converts between bytes and messages.
///
/// A client is admitted if it knows the token. A WebSocket may send it in the query of its handshake, and must do so if
/// it has an Origin, that is, if a page of a web browser connects. Otherwise the first message must be the token alone.
/// Before admission, nothing else is processed, and at most a few kilobytes are kept. One thread. The terms must
/// outlive the connection.
class ControlConnection {
 public:
  ControlConnection(ControlProtocol protocol, const ControlTerms& terms);

  /// Takes bytes of the client. `take_messages` returns their messages.
  void receive(std::string_view bytes);
  [[nodiscard]] std::vector<std::string> take_messages();
  /// Queues a message for the client: UTF-8 without line ends.
  void send(std::string_view message);
  /// Closes the connection: reads nothing more, and sends only the reason.
  void close(WebSocketClose code, const std::string& why);

  [[nodiscard]] bool is_admitted() const { return admitted_; }
  /// Returns the bytes to send. The connection ends when it is closing and they are empty.
  [[nodiscard]] std::string_view outgoing() const { return std::string_view(outgoing_).substr(sent_); }
  void sent(std::size_t bytes);
  [[nodiscard]] bool is_closing() const { return closing_; }

 private:
  void receive_head(std::string_view bytes);
  void receive_lines(std::string_view bytes);
  void receive_frames(std::string_view bytes);
  void take(std::string&& message);
  void admit();

  ControlProtocol protocol_;
  const ControlTerms& terms_;
  WebSocketDecoder decoder_;
  std::string head_;   // head of the handshake, or the incomplete line
  bool open_ = false;  // the handshake is complete
  bool admitted_ = false, closing_ = false;
  std::vector<std::string> messages_;
  std::string outgoing_;
  std::size_t sent_ = 0;  // of outgoing_
};

}  // namespace gs::net
