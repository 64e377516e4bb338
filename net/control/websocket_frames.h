#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace gs::net {

/// Why a WebSocket is closed (RFC 6455 7.4.1).
enum class WebSocketClose : std::uint16_t {
  normal = 1000,
  going_away = 1001,
  protocol_error = 1002,
  unacceptable = 1003,  // data of a kind that is not taken
  invalid_data = 1007,  // text that is no UTF-8
  policy = 1008,
  too_large = 1009,
  try_again_later = 1013,
};

/// The opcodes of RFC 6455 5.2.
enum class WebSocketOpcode : std::uint8_t { continuation = 0, text = 1, binary = 2, close = 8, ping = 9, pong = 10 };

/// What a client has sent: a whole message of text, whatever frames it came in, or a control frame.
struct WebSocketMessage {
  WebSocketOpcode kind = WebSocketOpcode::text;
  std::string payload;
};

/// Reads the frames of a client (RFC 6455 5), in pieces of any size. After a failure it takes nothing more. Holds at
/// most a message and a control frame; memory follows what has come, not what a frame says that it will have.
class WebSocketDecoder {
 public:
  struct Failure {
    WebSocketClose code = WebSocketClose::protocol_error;
    std::string why;
  };
  /// `most_bytes`: of a message.
  explicit WebSocketDecoder(std::size_t most_bytes) : most_(most_bytes) {}

  void set_most(std::size_t most_bytes) { most_ = most_bytes; }
  /// Hands whole messages to `take`; stops where that says so, or behind a failure. How many bytes were read.
  std::size_t push(std::string_view bytes, const std::function<bool(WebSocketMessage&&)>& take);
  [[nodiscard]] const std::optional<Failure>& failure() const { return failure_; }

 private:
  [[nodiscard]] std::size_t header_size() const;
  void begin_frame();
  bool end_frame(const std::function<bool(WebSocketMessage&&)>& take);
  void fail(WebSocketClose code, std::string why) { failure_ = Failure{code, std::move(why)}; }

  std::size_t most_;
  std::optional<Failure> failure_;
  std::string header_;  // of the frame, as far as it has come
  bool in_payload_ = false;
  WebSocketOpcode opcode_ = WebSocketOpcode::text;
  bool final_ = false;
  std::uint64_t left_ = 0;  // bytes of the payload
  std::size_t masked_ = 0;  // of those that came: where in the mask the next one is
  char mask_[4] = {};
  bool in_message_ = false;  // a fragment of it has come, and the last one has not
  std::size_t fragments_ = 0;
  std::string message_, control_;
};

/// A frame of a server: whole and unmasked (RFC 6455 5.1). `payload` of control frames: at most 125 bytes.
[[nodiscard]] std::string websocket_frame(WebSocketOpcode opcode, std::string_view payload);
/// A close frame; the reason is cut to what a control frame holds, between characters.
[[nodiscard]] std::string websocket_close_frame(WebSocketClose code, std::string_view why);

}  // namespace gs::net
