#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace gs::net {

/// Status code for closing a WebSocket (RFC 6455 7.4.1).
enum class WebSocketClose : std::uint16_t {
  normal = 1000,
  going_away = 1001,
  protocol_error = 1002,
  unacceptable = 1003,  // the message has an unsupported type
  invalid_data = 1007,  // the text is not UTF-8
  policy = 1008,
  too_large = 1009,
  try_again_later = 1013,
};

/// Opcodes of RFC 6455 5.2.
enum class WebSocketOpcode : std::uint8_t { continuation = 0, text = 1, binary = 2, close = 8, ping = 9, pong = 10 };

/// Message from a client: a complete text message, joined from its frames, or a control frame.
struct WebSocketMessage {
  WebSocketOpcode kind = WebSocketOpcode::text;
  std::string payload;
};

/// Decodes the frames of a client (RFC 6455 5), in pieces of any size. Stops after a failure. Holds at most one message
/// and one control frame. Memory grows with the received bytes, not with the length in a frame header.
class WebSocketDecoder {
 public:
  struct Failure {
    WebSocketClose code = WebSocketClose::protocol_error;
    std::string why;
  };
  /// Creates a decoder for messages of at most `most_bytes` bytes.
  explicit WebSocketDecoder(std::size_t most_bytes) : most_(most_bytes) {}

  void set_most(std::size_t most_bytes) { most_ = most_bytes; }
  /// Passes complete messages to `take`. Stops if `take` returns false, and after a failure. Returns the number of
  /// bytes that were read.
  std::size_t push(std::string_view bytes, const std::function<bool(WebSocketMessage&&)>& take);
  [[nodiscard]] const std::optional<Failure>& failure() const { return failure_; }

 private:
  [[nodiscard]] std::size_t header_size() const;
  void begin_frame();
  bool end_frame(const std::function<bool(WebSocketMessage&&)>& take);
  void fail(WebSocketClose code, std::string why) { failure_ = Failure{code, std::move(why)}; }

  std::size_t most_;
  std::optional<Failure> failure_;
  std::string header_;  // received part of the frame's header
  bool in_payload_ = false;
  WebSocketOpcode opcode_ = WebSocketOpcode::text;
  bool final_ = false;
  std::uint64_t left_ = 0;  // remaining bytes of the current payload
  std::size_t masked_ = 0;  // index in the mask for the next payload byte, 0 to 3
  char mask_[4] = {};
  bool in_message_ = false;  // the last fragment of the message is not received yet
  std::size_t fragments_ = 0;
  std::string message_, control_;
};

/// Encodes a frame of a server: unfragmented and unmasked (RFC 6455 5.1). The payload of a control frame has at most
/// 125 bytes.
[[nodiscard]] std::string websocket_frame(WebSocketOpcode opcode, std::string_view payload);
/// Encodes a close frame. Shortens the reason at a character boundary to fit into a control frame.
[[nodiscard]] std::string websocket_close_frame(WebSocketClose code, std::string_view why);

}  // namespace gs::net
