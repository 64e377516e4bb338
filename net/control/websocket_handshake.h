#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace gs::net {

/// What a client asks for who opens a WebSocket (RFC 6455 4.1).
struct WebSocketRequest {
  std::string key;                    // Sec-WebSocket-Key
  std::string host;                   // as it was sent
  std::optional<std::string> origin;  // of the page, where a web browser asks
  std::optional<std::string> token;   // "token" of the query
};

/// Why it is not opened: a status of HTTP and a line of text.
struct WebSocketRefusal {
  int status = 400;
  std::string why;
};

/// Reads a request, from its first line to the empty one.
[[nodiscard]] std::variant<WebSocketRequest, WebSocketRefusal> parse_websocket_request(std::string_view head);
/// The answer that opens it (4.2.2).
[[nodiscard]] std::string websocket_answer(const WebSocketRequest& request);
/// The answer that does not, behind which the connection is closed.
[[nodiscard]] std::string websocket_refusal(const WebSocketRefusal& refusal);
/// Sec-WebSocket-Accept of a key.
[[nodiscard]] std::string websocket_accept(std::string_view key);

}  // namespace gs::net
