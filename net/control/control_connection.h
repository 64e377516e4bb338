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
  // Maximum bytes of a client's messages that the owner has not taken. Above it, the server stops reading from the
  // client.
  std::size_t waiting_bytes = std::size_t{8} << 20;
  std::size_t waiting_messages = 4096;  // maximum number of messages that the owner has not taken
  // Maximum bytes that a client has not read. Above it, the server disconnects the client.
  std::size_t outgoing_bytes = std::size_t{16} << 20;
  std::size_t clients = 16;  // maximum number of admitted clients
  // Maximum number of clients that are not admitted yet. Above it, the server disconnects the oldest.
  std::size_t strangers = 64;
  Instant admission{10'000'000};  // maximum time until admission
};

/// Settings that all control connections share.
struct ControlTerms {
  std::string token;
  ControlLimits limits;
  /// Returns the last message to a disconnected client with the protocol `lines`. A WebSocket client gets a close frame
  /// instead.
  std::function<std::string(const std::string& why)> farewell;
};

/// State machine of one connection, without its socket. Converts between bytes and messages.
///
/// A client must send the token to be admitted. A web page must send it in the query of the WebSocket handshake; any
/// handshake with an Origin counts as a web page. Other WebSocket clients may do so. All others send the token alone as
/// their first message.
///
/// Before admission, processes nothing else and stores at most a few kilobytes. One thread. The terms must outlive the
/// connection.
class ControlConnection {
 public:
  ControlConnection(ControlProtocol protocol, const ControlTerms& terms);

  /// Takes received bytes. `take_messages` returns the messages in them.
  void receive(std::string_view bytes);
  [[nodiscard]] std::vector<std::string> take_messages();
  /// Queues a message to the client. `message` is UTF-8 without line ends.
  void send(std::string_view message);
  /// Closes the connection. After this, it reads no more bytes and sends only the reason.
  void close(WebSocketClose code, const std::string& why);

  [[nodiscard]] bool is_admitted() const { return admitted_; }
  /// Returns the bytes to send. A closing connection ends when they are empty.
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
  std::string head_;  // head of the handshake, or an incomplete line
  bool open_ = false;  // the handshake or the protocol `lines` has begun
  bool admitted_ = false, closing_ = false;
  std::vector<std::string> messages_;
  std::string outgoing_;
  std::size_t sent_ = 0;  // sent bytes of outgoing_
};

}  // namespace gs::net
