#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace gs::net::test {

/// Returns a masked frame of a client (RFC 6455 5.2). `first`: FIN, reserved bits and opcode.
inline std::string masked_frame(unsigned first, std::string_view payload, std::string_view mask = "\x37\xfa\x21\x3d") {
  std::string frame(1, static_cast<char>(first));
  const std::uint64_t size = payload.size();
  const int bytes = size < 126 ? 0 : size < 65536 ? 2 : 8;
  frame += static_cast<char>(0x80 | (bytes == 0 ? size : bytes == 2 ? 126 : 127));
  for (int i = bytes - 1; i >= 0; --i) frame += static_cast<char>(size >> (8 * i) & 0xff);
  frame += mask.substr(0, 4);
  for (std::size_t i = 0; i < payload.size(); ++i) frame += static_cast<char>(payload[i] ^ mask[i % 4]);
  return frame;
}

/// Returns a request that opens a WebSocket, with the key of RFC 6455 1.3.
inline std::string opening(const std::string& target = "/", const std::string& more = "",
                           const std::string& host = "127.0.0.1:7000") {
  return "GET " + target + " HTTP/1.1\r\nHost: " + host +
         "\r\nUpgrade: websocket\r\nConnection: keep-alive, Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
         "Sec-WebSocket-Version: 13\r\n" +
         more + "\r\n";
}

}  // namespace gs::net::test
