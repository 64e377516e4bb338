#include "net/control/control_connection.h"
#include "masked_frames.h"
#include "net/control/control_token.h"
#include "net/control/websocket_handshake.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace gs::net::control_connection_test {
namespace {

using test::masked_frame;
using test::opening;
using Lines = std::vector<std::string>;

const std::string kToken = "0123456789abcdef0123456789abcdef";

ControlTerms terms() {
  ControlTerms result;
  result.token = kToken;
  result.limits.message_bytes = 1000;
  result.farewell = [](const std::string& why) { return "BYE " + why; };
  return result;
}

struct Peer {
  explicit Peer(ControlProtocol protocol) : connection(protocol, of) {}
  /// Passes bytes to the connection, and returns its answer.
  std::string say(std::string_view bytes) {
    connection.receive(bytes);
    for (std::string& one : connection.take_messages()) messages.push_back(std::move(one));
    std::string out(connection.outgoing());
    connection.sent(out.size());
    return out;
  }
  ControlTerms of = terms();
  ControlConnection connection;
  Lines messages;
};

int status_of(const std::string& answer) {
  REQUIRE(answer.starts_with("HTTP/1.1 "));
  return std::stoi(answer.substr(9));
}

int refused(const std::string& request) {
  Peer peer(ControlProtocol::web_socket);
  const std::string answer = peer.say(request);
  CHECK(peer.connection.is_closing());
  CHECK_FALSE(peer.connection.is_admitted());
  return status_of(answer);
}

}  // namespace

TEST_CASE("answers the WebSocket key of RFC 6455 1.3") {
  CHECK(websocket_accept("dGhlIHNhbXBsZSBub25jZQ==") == "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  Peer peer(ControlProtocol::web_socket);
  const std::string answer = peer.say(opening("/?token=" + kToken));
  CHECK(status_of(answer) == 101);
  CHECK(answer.find("\r\nSec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n") != std::string::npos);
  CHECK(peer.connection.is_admitted());
}

TEST_CASE("accepts a handshake in any pieces, followed by frames") {
  const std::string bytes = opening("/?token=" + kToken) + masked_frame(0x81, "one") + masked_frame(0x81, "two");
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    Peer peer(ControlProtocol::web_socket);
    std::string answer = peer.say(std::string_view(bytes).substr(0, cut));
    answer += peer.say(std::string_view(bytes).substr(cut));
    REQUIRE(status_of(answer) == 101);
    REQUIRE(peer.messages == Lines{"one", "two"});
  }
}

TEST_CASE("refuses an invalid handshake with an HTTP status") {
  CHECK(refused("hello\r\n\r\n") == 400);
  CHECK(refused("POST / HTTP/1.1\r\nHost: localhost\r\n\r\n{}") == 405);
  CHECK(refused("GET / HTTP/1.0\r\n\r\n") == 505);
  CHECK(refused(opening("/other")) == 404);
  CHECK(refused("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n") == 426);
  CHECK(refused(opening("/", "Sec-WebSocket-Version: 8\r\n")) == 426);  // the field occurs twice
  CHECK(refused(opening("/", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n")) == 400);
  CHECK(refused(opening("/", "Na me: x\r\n")) == 400);
  CHECK(refused(opening("/", "Name: \x01\r\n")) == 400);
  CHECK(refused("GET / HTTP/1.1\r\n" + std::string(9000, 'a')) == 431);
}

TEST_CASE("requires the token from web pages in the handshake, and rejects foreign names of this machine") {
  const std::string page = "Origin: https://example.org\r\n";
  CHECK(refused(opening("/", page)) == 403);
  CHECK(refused(opening("/", "Origin: null\r\n")) == 403);
  CHECK(refused(opening("/?token=" + std::string(32, '0'), page)) == 401);
  CHECK(refused(opening("/?token=" + kToken, page, "rebound.example:7000")) == 403);
  CHECK(refused(opening("/?token=" + kToken, "", "")) == 403);
  Peer knows(ControlProtocol::web_socket);
  CHECK(status_of(knows.say(opening("/?other=1&token=" + kToken, page, "localhost:7000"))) == 101);
  CHECK(knows.connection.is_admitted());
}

TEST_CASE("admits a client without Origin by a first message with the token only") {
  Peer right(ControlProtocol::web_socket);
  (void)right.say(opening());
  CHECK_FALSE(right.connection.is_admitted());
  CHECK(right.say(masked_frame(0x81, kToken) + masked_frame(0x81, "call")).empty());
  CHECK(right.connection.is_admitted());
  CHECK(right.messages == Lines{"call"});
  for (const std::string& wrong : {std::string("call"), kToken + "0", kToken.substr(1), std::string(32, '0')}) {
    Peer peer(ControlProtocol::web_socket);
    (void)peer.say(opening());
    // 1008: policy
    CHECK(peer.say(masked_frame(0x81, wrong) + masked_frame(0x81, "call")).substr(2, 2) == "\x03\xf0");
    CHECK(peer.connection.is_closing());
    CHECK(peer.messages.empty());
  }
}

TEST_CASE("takes the first line as token and each other line as message, in any pieces") {
  const std::string bytes = kToken + "\n{\"a\":1}\r\n\n\n{}\n";
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    Peer peer(ControlProtocol::lines);
    REQUIRE(peer.say(std::string_view(bytes).substr(0, cut)).empty());
    REQUIRE(peer.say(std::string_view(bytes).substr(cut)).empty());
    REQUIRE(peer.messages == Lines{"{\"a\":1}", "{}"});
  }
  Peer peer(ControlProtocol::lines);
  CHECK(peer.say("GET / HTTP/1.1\n") == "BYE wrong token\n");
  CHECK(peer.connection.is_closing());
}

TEST_CASE("bounds the input of clients before and after admission") {
  Peer stranger(ControlProtocol::lines);
  CHECK(stranger.say(std::string(257, 'a')) == "BYE a line of more than 256 bytes\n");
  Peer frames(ControlProtocol::web_socket);
  (void)frames.say(opening());
  CHECK(frames.say(masked_frame(0x81, std::string(257, 'a'))).substr(2, 2) == "\x03\xf1");  // 1009
  Peer known(ControlProtocol::lines);
  CHECK(known.say(kToken + "\n" + std::string(1000, 'a') + "\n").empty());
  CHECK(known.messages.size() == 1);
  CHECK(known.say(std::string(600, 'a')).empty());
  CHECK(known.say(std::string(401, 'a')) == "BYE a line of more than 1000 bytes\n");
  CHECK(known.connection.is_closing());
  CHECK(known.say("more\n").empty());
  CHECK(known.messages.size() == 1);
  Peer bytes(ControlProtocol::lines);
  CHECK(bytes.say(kToken + "\n\xff\n") == "BYE text is not UTF-8\n");
}

TEST_CASE("answers pings and close frames, and sends messages in the form of each protocol") {
  Peer peer(ControlProtocol::web_socket);
  (void)peer.say(opening("/?token=" + kToken));
  CHECK(peer.say(masked_frame(0x89, "abc")) ==
        "\x8a\x03"
        "abc");
  peer.connection.send("text");
  CHECK(peer.say("") == "\x81\x04text");
  CHECK(peer.say(masked_frame(0x88, "\x03\xe8")) == "\x88\x02\x03\xe8");
  CHECK(peer.connection.is_closing());
  peer.connection.send("late");
  CHECK(peer.say("").empty());
  Peer lines(ControlProtocol::lines);
  (void)lines.say(kToken + "\n");
  lines.connection.send("text");
  CHECK(lines.say("") == "text\n");
}

TEST_CASE("makes different tokens of 32 hexadecimal digits, and compares them as a whole") {
  const std::string token = make_control_token();
  CHECK(token.size() == 32);
  CHECK(token.find_first_not_of("0123456789abcdef") == std::string::npos);
  CHECK(make_control_token() != token);
  CHECK(same_secret(token, token));
  CHECK_FALSE(same_secret(token, token.substr(0, 31)));
  CHECK_FALSE(same_secret("", token));
  for (std::size_t i = 0; i < token.size(); ++i) {
    std::string other = token;
    other[i] = static_cast<char>(other[i] ^ 1);
    CHECK_FALSE(same_secret(token, other));
  }
}

}  // namespace gs::net::control_connection_test
