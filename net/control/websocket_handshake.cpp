#include "net/control/websocket_handshake.h"

#include "net/base/header_text.h"
#include "net/control/digest.h"

#include <algorithm>
#include <map>

namespace gs::net {
namespace {

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  return result;
}

// Reports whether a comma-separated list contains a word. Ignores case.
bool list_has(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    if (lower_case(without_blanks(list.substr(0, comma))) == word) return true;
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return false;
}

bool is_header_name(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
  });
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; });
}

std::optional<std::string> token_of(std::string_view query) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view one = query.substr(0, end);
    constexpr std::string_view kName = "token=";
    if (one.starts_with(kName)) return std::string(one.substr(kName.size()));
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return std::nullopt;
}

}  // namespace

std::variant<WebSocketRequest, WebSocketRefusal> parse_websocket_request(std::string_view head) {
  const auto line = [&] {
    const std::size_t end = std::min(head.find('\n'), head.size());
    std::string_view one = head.substr(0, end);
    head.remove_prefix(std::min(end + 1, head.size()));
    if (one.ends_with('\r')) one.remove_suffix(1);
    return one;
  };
  const std::string_view first = line();
  const std::size_t one = first.find(' '), two = first.rfind(' ');
  if (one == std::string_view::npos || one == two || has_control(first) || !first.substr(two + 1).starts_with("HTTP/"))
    return WebSocketRefusal{400, "not an HTTP request"};
  if (first.substr(0, one) != "GET") return WebSocketRefusal{405, "expected GET"};
  if (first.substr(two + 1) != "HTTP/1.1") return WebSocketRefusal{505, "expected HTTP/1.1"};
  const std::string_view target = first.substr(one + 1, two - one - 1);
  const std::size_t mark = std::min(target.find('?'), target.size());
  if (target.substr(0, mark) != "/") return WebSocketRefusal{404, "only the path / exists"};
  std::map<std::string, std::string> headers;
  for (std::string_view text = line(); !text.empty(); text = line()) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos || !is_header_name(text.substr(0, colon)) || has_control(text))
      return WebSocketRefusal{400, "invalid header field"};
    std::string& value = headers[lower_case(text.substr(0, colon))];
    // A list may span several fields of one name (RFC 9110 5.3). If the field must be unique, the joined value is
    // invalid.
    value += (value.empty() ? "" : ", ") + std::string(without_blanks(text.substr(colon + 1)));
  }
  if (!list_has(headers["upgrade"], "websocket") || !list_has(headers["connection"], "upgrade"))
    return WebSocketRefusal{426, "expected a WebSocket (RFC 6455)"};
  if (headers["sec-websocket-version"] != "13") return WebSocketRefusal{426, "expected Sec-WebSocket-Version 13"};
  const auto key = base64_bytes(headers["sec-websocket-key"]);
  if (!key || key->size() != 16) return WebSocketRefusal{400, "expected a Sec-WebSocket-Key of 16 bytes"};
  WebSocketRequest request;
  request.key = headers["sec-websocket-key"];
  request.host = headers["host"];
  if (const auto origin = headers.find("origin"); origin != headers.end()) request.origin = origin->second;
  request.token = token_of(target.substr(std::min(mark + 1, target.size())));
  return request;
}

std::string websocket_accept(std::string_view key) {
  return base64(sha1(std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"));
}

std::string websocket_answer(const WebSocketRequest& request) {
  return "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: " +
         websocket_accept(request.key) + "\r\n\r\n";
}

std::string websocket_refusal(const WebSocketRefusal& refusal) {
  const std::string body = refusal.why + "\n";
  const char* const name = refusal.status == 401   ? "Unauthorized"
                           : refusal.status == 403 ? "Forbidden"
                           : refusal.status == 404 ? "Not Found"
                           : refusal.status == 405 ? "Method Not Allowed"
                           : refusal.status == 426 ? "Upgrade Required"
                           : refusal.status == 431 ? "Request Header Fields Too Large"
                           : refusal.status == 505 ? "HTTP Version Not Supported"
                                                   : "Bad Request";
  return "HTTP/1.1 " + std::to_string(refusal.status) + " " + name + "\r\nConnection: close\r\n" +
         (refusal.status == 426 ? "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n" : "") +
         "Content-Type: text/plain\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

}  // namespace gs::net
