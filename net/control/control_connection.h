#pragma once

#include "net/base/host_names.h"
#include "net/base/token_bucket.h"
#include "net/control/websocket_frames.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::net {

/// How messages are told from each other.
enum class ControlProtocol : std::uint8_t {
  lines,       // a message a line
  web_socket,  // RFC 6455
};

struct ControlLimits {
  std::size_t message_bytes = std::size_t{4} << 20;    // of one message of a client who is admitted
  std::size_t waiting_bytes = std::size_t{8} << 20;    // of a client's messages that nobody has taken: no more are read
  std::size_t waiting_messages = 4096;                 // the same, by number
  std::size_t outgoing_bytes = std::size_t{16} << 20;  // that a client has not read: it is cut off
  std::size_t clients = 16;                            // who are admitted
  std::size_t strangers = 64;                          // who are not, yet: the one who is there longest goes
  Instant admission{10'000'000};                       // so long may that take
};

/// What connections have in common.
struct ControlTerms {
  std::string token;
  ControlLimits limits;
  /// The last message to a client who speaks lines and is sent away; a WebSocket has a close frame for that.
  std::function<std::string(const std::string& why)> farewell;
};

/// One connection, without its socket: bytes of the client in, messages out, and back. A client is admitted who says
/// the token: in the query of the handshake of a WebSocket, where it must be if a page of a web browser asks (it has an
/// Origin), else in the first message, of which it is all. Nothing that others send is looked at before, and no more
/// than a few kilobytes of it are kept. One thread; the terms must outlive it.
class ControlConnection {
 public:
  ControlConnection(ControlProtocol protocol, const ControlTerms& terms);

  /// What the client has sent; messages go to `take_messages`.
  void receive(std::string_view bytes);
  [[nodiscard]] std::vector<std::string> take_messages();
  /// A message for the client, of UTF-8 without line ends.
  void send(std::string_view message);
  /// Nothing more is read and sent but the reason.
  void close(WebSocketClose code, const std::string& why);

  [[nodiscard]] bool is_admitted() const { return admitted_; }
  /// What is to be sent; the connection ends when this is empty and it is closing.
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
  std::string head_;   // of the handshake, or the line that has begun
  bool open_ = false;  // the handshake is over
  bool admitted_ = false, closing_ = false;
  std::vector<std::string> messages_;
  std::string outgoing_;
  std::size_t sent_ = 0;  // of outgoing_
};

}  // namespace gs::net
