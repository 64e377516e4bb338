#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace gs::net {

/// Request of a client that opens a WebSocket (RFC 6455 4.1).
struct WebSocketRequest {
  std::string key;                    // Sec-WebSocket-Key
  std::string host;  // Host field as received
  std::optional<std::string> origin;  // origin of the page, if a web browser connects
  std::optional<std::string> token;   // parameter "token" of the query
};

/// Reason for refusing a WebSocket: an HTTP status and a line of text.
struct WebSocketRefusal {
  int status = 400;
  std::string why;
};

/// Parses a request, with all lines up to the empty line.
[[nodiscard]] std::variant<WebSocketRequest, WebSocketRefusal> parse_websocket_request(std::string_view head);
/// Returns the response that opens the WebSocket (RFC 6455 4.2.2).
[[nodiscard]] std::string websocket_answer(const WebSocketRequest& request);
/// Returns the response that refuses the WebSocket. The caller closes the connection after it.
[[nodiscard]] std::string websocket_refusal(const WebSocketRefusal& refusal);
/// Returns the value of Sec-WebSocket-Accept for a key.
[[nodiscard]] std::string websocket_accept(std::string_view key);

}  // namespace gs::net
