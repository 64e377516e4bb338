#include "net/control/control_connection.h"

#include "net/control/control_token.h"
#include "net/control/digest.h"
#include "net/control/websocket_handshake.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace gs::net {
namespace {

constexpr std::size_t kMaxHead = 8192;  // maximum bytes of a handshake
constexpr std::size_t kMaxFirstMessage = 256;  // maximum bytes of the first message, before the client is admitted
constexpr std::size_t kWorthMoving = std::size_t{64} << 10;

const char kWrongToken[] = "wrong token";

}  // namespace

ControlConnection::ControlConnection(ControlProtocol protocol, const ControlTerms& terms)
    : protocol_(protocol), terms_(terms), decoder_(kMaxFirstMessage), open_(protocol == ControlProtocol::lines) {}

void ControlConnection::receive(std::string_view bytes) {
  if (closing_) return;
  if (!open_) return receive_head(bytes);
  if (protocol_ == ControlProtocol::lines) return receive_lines(bytes);
  receive_frames(bytes);
}

void ControlConnection::receive_head(std::string_view bytes) {
  const std::size_t before = head_.size();
  head_.append(bytes.substr(0, kMaxHead - before));
  const std::size_t end = head_.find("\r\n\r\n", before < 3 ? 0 : before - 3);
  const auto refuse = [&](const WebSocketRefusal& refusal) {
    outgoing_ += websocket_refusal(refusal);
    closing_ = true;
  };
  if (end == std::string::npos) {
    if (head_.size() == kMaxHead) refuse({431, "the request exceeds 8192 bytes"});
    return;
  }
  const auto parsed = parse_websocket_request(std::string_view(head_).substr(0, end + 2));
  const std::string_view behind = bytes.substr(end + 4 - before);
  head_ = {};
  if (const auto* refusal = std::get_if<WebSocketRefusal>(&parsed)) return refuse(*refusal);
  const auto& request = std::get<WebSocketRequest>(parsed);
  // Refuse pages from a host name that resolves to this machine (DNS rebinding), even with a token.
  static const HostNames names("127.0.0.1", {});
  if (!names.admits(request.host)) return refuse({403, "not a name of this machine"});
  const bool knows = request.token && same_secret(*request.token, terms_.token);
  if (request.token && !knows) return refuse({401, kWrongToken});
  if (request.origin && !knows) return refuse({403, "pages need the token: ws://.../?token=TOKEN"});
  outgoing_ += websocket_answer(request);
  open_ = true;
  if (knows) admit();
  receive_frames(behind);
}

void ControlConnection::receive_frames(std::string_view bytes) {
  (void)decoder_.push(bytes, [this](WebSocketMessage&& message) {
    switch (message.kind) {
      case WebSocketOpcode::ping:
        outgoing_ += websocket_frame(WebSocketOpcode::pong, message.payload);
        return true;
      case WebSocketOpcode::close:
        close(WebSocketClose::normal, "");
        return false;
      case WebSocketOpcode::text:
        take(std::move(message.payload));
        return !closing_;
      default:
        return true;  // ignore pongs without a ping (RFC 6455 5.5.3)
    }
  });
  if (decoder_.failure()) close(decoder_.failure()->code, decoder_.failure()->why);
}

void ControlConnection::receive_lines(std::string_view bytes) {
  while (!bytes.empty() && !closing_) {
    const std::size_t most = admitted_ ? terms_.limits.message_bytes : kMaxFirstMessage;
    const std::size_t end = bytes.find('\n');
    const std::string_view piece = bytes.substr(0, end);
    if (piece.size() > most || head_.size() > most - piece.size())
      return close(WebSocketClose::too_large, "a line of more than " + std::to_string(most) + " bytes");
    head_ += piece;
    if (end == std::string_view::npos) return;
    bytes.remove_prefix(end + 1);
    std::string line = std::exchange(head_, {});
    if (line.ends_with('\r')) line.pop_back();
    if (!is_utf8(line)) return close(WebSocketClose::invalid_data, "text is not UTF-8");
    if (!line.empty()) take(std::move(line));
  }
}

void ControlConnection::take(std::string&& message) {
  if (admitted_) return messages_.push_back(std::move(message));
  if (!same_secret(message, terms_.token)) return close(WebSocketClose::policy, kWrongToken);
  admit();
}

void ControlConnection::admit() {
  admitted_ = true;
  decoder_.set_most(terms_.limits.message_bytes);
}

std::vector<std::string> ControlConnection::take_messages() { return std::exchange(messages_, {}); }

void ControlConnection::send(std::string_view message) {
  if (closing_ || !open_) return;
  if (protocol_ == ControlProtocol::lines) {
    outgoing_ += message;
    outgoing_ += '\n';
  } else {
    outgoing_ += websocket_frame(WebSocketOpcode::text, message);
  }
}

void ControlConnection::close(WebSocketClose code, const std::string& why) {
  if (closing_) return;
  if (protocol_ == ControlProtocol::web_socket) {
    if (open_) outgoing_ += websocket_close_frame(code, why);
  } else if (!why.empty()) {
    send(terms_.farewell ? terms_.farewell(why) : why);
  }
  closing_ = true;
}

void ControlConnection::sent(std::size_t bytes) {
  sent_ += bytes;
  if (sent_ == outgoing_.size()) {
    outgoing_.clear();
    if (outgoing_.capacity() > kWorthMoving) outgoing_.shrink_to_fit();
    sent_ = 0;
  } else if (sent_ > kWorthMoving && sent_ > outgoing_.size() / 2) {
    outgoing_.erase(0, sent_);
    sent_ = 0;
  }
}

}  // namespace gs::net
