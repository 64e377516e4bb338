#include "net/control/websocket_frames.h"

#include "net/control/digest.h"

#include <algorithm>
#include <utility>

namespace gs::net {
namespace {

constexpr std::size_t kMaxControl = 125;  // maximum bytes of a control frame's payload (RFC 6455 5.5)
constexpr std::size_t kMaxFragments = 10'000;

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

bool is_control(WebSocketOpcode opcode) { return opcode >= WebSocketOpcode::close; }

bool is_known(unsigned opcode) { return opcode <= 2 || (opcode >= 8 && opcode <= 10); }

// Reports whether a peer may send this status code in a close frame (RFC 6455 7.4).
bool may_be_sent(std::uint64_t code) {
  if (code >= 3000) return code <= 4999;
  return code >= 1000 && code <= 1014 && code != 1004 && code != 1005 && code != 1006;
}

}  // namespace

std::size_t WebSocketDecoder::header_size() const {
  if (header_.size() < 2) return 2;
  const unsigned length = static_cast<unsigned char>(header_[1]) & 0x7f;
  return 2 + (length == 126 ? 2 : length == 127 ? 8 : 0) + 4;
}

std::size_t WebSocketDecoder::push(std::string_view bytes, const std::function<bool(WebSocketMessage&&)>& take) {
  const std::size_t all = bytes.size();
  bool go_on = true;
  while (go_on && !bytes.empty() && !failure_) {
    if (!in_payload_) {
      const std::size_t count = std::min(header_size() - header_.size(), bytes.size());
      header_.append(bytes.substr(0, count));
      bytes.remove_prefix(count);
      if (header_.size() < header_size() && header_.size() != 2) continue;
      begin_frame();  // runs twice: after two bytes, and when the header is complete
    } else {
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left_, bytes.size()));
      std::string& to = is_control(opcode_) ? control_ : message_;
      const std::size_t first = to.size();
      to.append(bytes.substr(0, count));
      for (std::size_t i = first; i < to.size(); ++i) to[i] = static_cast<char>(to[i] ^ mask_[masked_++ & 3]);
      bytes.remove_prefix(count);
      left_ -= count;
    }
    if (in_payload_ && left_ == 0 && !failure_) go_on = end_frame(take);
  }
  return all - bytes.size();
}

void WebSocketDecoder::begin_frame() {
  const unsigned first = static_cast<unsigned char>(header_[0]), second = static_cast<unsigned char>(header_[1]);
  const unsigned short_length = second & 0x7f;
  if ((first & 0x70) != 0) return fail(WebSocketClose::protocol_error, "reserved bits are set without an extension");
  if (!is_known(first & 0x0f)) return fail(WebSocketClose::protocol_error, "unknown opcode");
  if ((second & 0x80) == 0) return fail(WebSocketClose::protocol_error, "expected masked frames of a client");
  opcode_ = static_cast<WebSocketOpcode>(first & 0x0f);
  final_ = (first & 0x80) != 0;
  if (is_control(opcode_)) {
    if (!final_) return fail(WebSocketClose::protocol_error, "fragmented control frame");
    if (short_length > kMaxControl) return fail(WebSocketClose::protocol_error, "control frame exceeds 125 bytes");
  } else if (opcode_ == WebSocketOpcode::binary) {
    return fail(WebSocketClose::unacceptable, "expected messages of text");
  } else if ((opcode_ == WebSocketOpcode::continuation) != in_message_) {
    return fail(WebSocketClose::protocol_error,
                in_message_ ? "a message starts inside another one" : "continuation without a message");
  }
  if (header_.size() < header_size()) return;  // wait for the rest of the header
  const std::string_view rest = std::string_view(header_).substr(2);
  left_ = short_length < 126 ? short_length : big_endian(rest.substr(0, rest.size() - 4));
  if ((short_length == 126 && left_ < 126) || (short_length == 127 && left_ < 65536) || left_ >> 63 != 0)
    return fail(WebSocketClose::protocol_error, "length is not in its shortest form");
  if (!is_control(opcode_)) {
    if (left_ > most_ || message_.size() + left_ > most_)
      return fail(WebSocketClose::too_large, "a message of more than " + std::to_string(most_) + " bytes");
    if (++fragments_ > kMaxFragments) return fail(WebSocketClose::policy, "the message has too many fragments");
    in_message_ = true;
  }
  std::copy_n(rest.end() - 4, 4, mask_);
  masked_ = 0;
  header_.clear();
  in_payload_ = true;
}

bool WebSocketDecoder::end_frame(const std::function<bool(WebSocketMessage&&)>& take) {
  in_payload_ = false;
  if (is_control(opcode_)) {
    std::string payload = std::exchange(control_, {});
    if (opcode_ == WebSocketOpcode::close && !payload.empty() &&
        (payload.size() < 2 || !may_be_sent(big_endian(payload.substr(0, 2))) || !is_utf8(payload.substr(2)))) {
      fail(WebSocketClose::protocol_error, "close frame with an invalid code");
      return false;
    }
    return take({opcode_, std::move(payload)});
  }
  if (!final_) return true;
  in_message_ = false;
  fragments_ = 0;
  std::string message = std::exchange(message_, {});
  if (!is_utf8(message)) {
    fail(WebSocketClose::invalid_data, "text is not UTF-8");
    return false;
  }
  return take({WebSocketOpcode::text, std::move(message)});
}

std::string websocket_frame(WebSocketOpcode opcode, std::string_view payload) {
  std::string frame;
  frame.reserve(payload.size() + 10);
  frame += static_cast<char>(0x80 | static_cast<unsigned>(opcode));
  const std::uint64_t size = payload.size();
  const int bytes = size < 126 ? 0 : size < 65536 ? 2 : 8;
  frame += static_cast<char>(bytes == 0 ? size : bytes == 2 ? 126 : 127);
  for (int i = bytes - 1; i >= 0; --i) frame += static_cast<char>(size >> (8 * i) & 0xff);
  frame += payload;
  return frame;
}

std::string websocket_close_frame(WebSocketClose code, std::string_view why) {
  const auto number = static_cast<unsigned>(code);
  std::string payload = {static_cast<char>(number >> 8), static_cast<char>(number & 0xff)};
  std::size_t size = std::min(why.size(), kMaxControl - 2);
  while (size > 0 && size < why.size() && (static_cast<unsigned char>(why[size]) & 0xc0) == 0x80) --size;
  payload += why.substr(0, size);
  return websocket_frame(WebSocketOpcode::close, payload);
}

}  // namespace gs::net
