#include "net/control/websocket_frames.h"
#include "masked_frames.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace gs::net::websocket_frames_test {
namespace {

using test::masked_frame;
using Kind = WebSocketOpcode;
using Messages = std::vector<std::pair<Kind, std::string>>;

struct Read {
  Messages messages;
  std::optional<WebSocketDecoder::Failure> failure;
  std::size_t bytes = 0;
};

/// Reads bytes in two pieces.
Read read(std::string_view bytes, std::size_t first = std::string_view::npos, std::size_t most = 1000) {
  WebSocketDecoder decoder(most);
  Read result;
  const auto take = [&](WebSocketMessage&& message) {
    result.messages.emplace_back(message.kind, std::move(message.payload));
    return true;
  };
  result.bytes = decoder.push(bytes.substr(0, first), take);
  if (first < bytes.size()) result.bytes += decoder.push(bytes.substr(first), take);
  result.failure = decoder.failure();
  return result;
}

WebSocketClose why(const std::string& bytes, std::size_t most = 1000) {
  const Read result = read(bytes, std::string_view::npos, most);
  REQUIRE(result.failure);
  CHECK_FALSE(result.failure->why.empty());
  return result.failure->code;
}

}  // namespace

TEST_CASE("reads and writes the frames of RFC 6455 5.7") {
  CHECK(read("\x81\x85\x37\xfa\x21\x3d\x7f\x9f\x4d\x51\x58").messages == Messages{{Kind::text, "Hello"}});
  CHECK(read("\x89\x85\x37\xfa\x21\x3d\x7f\x9f\x4d\x51\x58").messages == Messages{{Kind::ping, "Hello"}});
  CHECK(websocket_frame(Kind::text, "Hello") == "\x81\x05Hello");
  CHECK(websocket_frame(Kind::pong, "Hello") == "\x8a\x05Hello");
  CHECK(websocket_frame(Kind::text, std::string(256, 'x')) ==
        std::string("\x81\x7e\x01\x00", 4) + std::string(256, 'x'));
  CHECK(websocket_frame(Kind::text, std::string(65536, 'x')).substr(0, 10) ==
        std::string("\x81\x7f\x00\x00\x00\x00\x00\x01\x00\x00", 10));
  CHECK(websocket_close_frame(WebSocketClose::protocol_error, "no") == std::string("\x88\x04\x03\xea") + "no");
}

TEST_CASE("reads the same messages however their bytes are cut") {
  const std::string bytes = masked_frame(0x81, "first") + masked_frame(0x01, "in ") + masked_frame(0x89, "ping") +
                            masked_frame(0x00, "three ") + masked_frame(0x80, "pieces \xc3\xa9") +
                            masked_frame(0x81, std::string(300, 'm')) + masked_frame(0x8a, "") +
                            masked_frame(0x81, "") + masked_frame(0x88, "\x03\xe8over");
  const Messages whole = {{Kind::text, "first"},
                          {Kind::ping, "ping"},
                          {Kind::text, "in three pieces \xc3\xa9"},
                          {Kind::text, std::string(300, 'm')},
                          {Kind::pong, ""},
                          {Kind::text, ""},
                          {Kind::close, "\x03\xe8over"}};
  CHECK(read(bytes).messages == whole);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    const Read in_two = read(bytes, cut);
    REQUIRE(in_two.messages == whole);
    REQUIRE_FALSE(in_two.failure);
    REQUIRE(in_two.bytes == bytes.size());
    const Read part = read(std::string_view(bytes).substr(0, cut));
    REQUIRE_FALSE(part.failure);
    REQUIRE(part.messages.size() <= whole.size());
    REQUIRE(std::equal(part.messages.begin(), part.messages.end(), whole.begin()));
  }
}

TEST_CASE("rejects invalid frames with their close codes (RFC 6455 5, 7.4.1)") {
  CHECK(why("\x81\x05Hello") == WebSocketClose::protocol_error);          // not masked
  CHECK(why(masked_frame(0xc1, "a")) == WebSocketClose::protocol_error);  // reserved bits
  CHECK(why(masked_frame(0x83, "a")) == WebSocketClose::protocol_error);  // reserved opcodes
  CHECK(why(masked_frame(0x8b, "a")) == WebSocketClose::protocol_error);
  CHECK(why(masked_frame(0x82, "a")) == WebSocketClose::unacceptable);  // binary
  CHECK(why(masked_frame(0x80, "a")) == WebSocketClose::protocol_error);
  CHECK(why(masked_frame(0x01, "a") + masked_frame(0x81, "b")) == WebSocketClose::protocol_error);
  CHECK(why(masked_frame(0x09, "a")) == WebSocketClose::protocol_error);  // a control frame in fragments
  CHECK(why(masked_frame(0x89, std::string(126, 'a'))) == WebSocketClose::protocol_error);
  CHECK(why(masked_frame(0x88, "a")) == WebSocketClose::protocol_error);         // a close code of one byte
  CHECK(why(masked_frame(0x88, "\x03\xed")) == WebSocketClose::protocol_error);  // 1005 is never sent
  CHECK(why(masked_frame(0x88, "\x03\xe8\xff")) == WebSocketClose::protocol_error);
  CHECK(why(masked_frame(0x81, "\xff")) == WebSocketClose::invalid_data);
  CHECK(why(masked_frame(0x01, "\xc3") + masked_frame(0x80, "(")) == WebSocketClose::invalid_data);
  // Two lengths are not in the shortest form. The third has its first bit set.
  CHECK(why(std::string("\x81\xfe\x00\x05", 4) + "mask") == WebSocketClose::protocol_error);
  CHECK(why(std::string("\x81\xff\x00\x00\x00\x00\x00\x00\xff\xff", 10) + "mask") == WebSocketClose::protocol_error);
  CHECK(why(std::string("\x81\xff\x80\x00\x00\x00\x00\x00\x00\x00", 10) + "mask") == WebSocketClose::protocol_error);
}

TEST_CASE("rejects too large messages at the header, and fragments without end") {
  CHECK(why(std::string("\x81\xff\x00\xff\xff\xff\xff\xff\xff\xff", 10) + "mask") == WebSocketClose::too_large);
  CHECK(read(masked_frame(0x81, std::string(1000, 'a'))).messages.size() == 1);
  CHECK(why(masked_frame(0x81, std::string(1001, 'a'))) == WebSocketClose::too_large);
  CHECK(why(masked_frame(0x01, std::string(900, 'a')) + masked_frame(0x00, std::string(101, 'a'))) ==
        WebSocketClose::too_large);
  std::string fragments = masked_frame(0x01, "");
  for (int i = 0; i < 10'000; ++i) fragments += masked_frame(0x00, "");
  CHECK(why(fragments) == WebSocketClose::policy);
}

TEST_CASE("reads nothing after a failure or after the receiver stops") {
  const Read result = read(masked_frame(0x81, "a") + masked_frame(0x83, "b") + masked_frame(0x81, "c"));
  CHECK(result.messages == Messages{{Kind::text, "a"}});
  CHECK(result.failure);
  WebSocketDecoder decoder(1000);
  int taken = 0;
  const std::string two = masked_frame(0x81, "a") + masked_frame(0x81, "b");
  const std::size_t used = decoder.push(two, [&](WebSocketMessage&&) { return ++taken < 1; });
  CHECK(taken == 1);
  CHECK(used == two.size() / 2);
}

TEST_CASE("cuts the reason of a close frame between characters to fit a control frame") {
  std::string long_reason;
  while (long_reason.size() < 200) long_reason += "\xe2\x82\xac";
  const std::string frame = websocket_close_frame(WebSocketClose::policy, long_reason);
  CHECK(frame.size() == 2 + 2 + 123);
  CHECK(frame.substr(4) == long_reason.substr(0, 123));
  CHECK(websocket_close_frame(WebSocketClose::policy, "x" + long_reason).substr(4) ==
        ("x" + long_reason).substr(0, 121));
}

}  // namespace gs::net::websocket_frames_test
