#include "net/tunnel/tunnel_frames.h"

#include <catch2/catch.hpp>

#include <string>
#include <tuple>
#include <vector>

namespace gs::net::tunnel_frames_test {
namespace {

using Frames = std::vector<std::tuple<int, std::uint32_t, std::string>>;

std::vector<std::byte> marked(const std::string& noise = {}) {
  const std::string text = noise + std::string(kTunnelMark);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

void drain(TunnelFrameReader& reader, Frames& frames) {
  while (const auto frame = reader.next())
    frames.emplace_back(static_cast<int>(frame->kind), frame->connection,
                        std::string(reinterpret_cast<const char*>(frame->payload.data()), frame->payload.size()));
}

std::vector<std::byte> sample() {
  std::vector<std::byte> bytes = marked("Welcome to \0the cluster\n");
  append_frame(bytes, TunnelFrameKind::hello, 0, std::string_view("protocols 1\n"));
  append_frame(bytes, TunnelFrameKind::open, 1);
  append_frame(bytes, TunnelFrameKind::data, 1, std::string_view("GET / HTTP/1.1\r\n"));
  append_frame(bytes, TunnelFrameKind::window, 0x01020304, std::uint32_t{65536});
  append_frame(bytes, static_cast<TunnelFrameKind>(200), 7, std::string_view("later"));
  return bytes;
}

}  // namespace

TEST_CASE("frames have a big-endian size, a kind and a connection") {
  std::vector<std::byte> bytes;
  append_frame(bytes, TunnelFrameKind::window, 0x01020304, std::uint32_t{0x0a0b0c0d});
  const unsigned char expected[] = {0, 0, 0, 4, 4, 1, 2, 3, 4, 10, 11, 12, 13};
  REQUIRE(bytes.size() == sizeof expected);
  for (std::size_t i = 0; i < bytes.size(); ++i) CHECK(std::to_integer<int>(bytes[i]) == expected[i]);
}

TEST_CASE("frames are the same however their bytes are cut, and prefixes give their complete frames") {
  const auto bytes = sample();
  Frames whole;
  TunnelFrameReader reader;
  REQUIRE_FALSE(reader.receive(bytes));
  drain(reader, whole);
  REQUIRE(whole.size() == 5);
  CHECK(whole[2] == std::tuple(3, 1u, std::string("GET / HTTP/1.1\r\n")));
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    TunnelFrameReader halves;
    Frames frames;
    REQUIRE_FALSE(halves.receive(std::span(bytes).first(cut)));
    drain(halves, frames);
    CHECK(std::equal(frames.begin(), frames.end(), whole.begin()));
    REQUIRE_FALSE(halves.receive(std::span(bytes).subspan(cut)));
    drain(halves, frames);
    CHECK(frames == whole);
  }
  TunnelFrameReader bytewise;
  Frames frames;
  for (const std::byte& one : bytes) {
    REQUIRE_FALSE(bytewise.receive({&one, 1}));
    drain(bytewise, frames);
  }
  CHECK(frames == whole);
}

TEST_CASE("a reader refuses frames that are too long and endless text before the mark") {
  std::vector<std::byte> bytes = marked();
  append_frame(bytes, TunnelFrameKind::data, 1);
  bytes[kTunnelMark.size() + 1] = std::byte{2};
  TunnelFrameReader reader;
  CHECK(reader.receive(bytes));
  TunnelFrameReader noisy;
  std::optional<std::string> problem;
  const std::vector<std::byte> noise(4096, std::byte{'x'});
  int pieces = 0;
  for (; !problem && pieces < 100; ++pieces) problem = noisy.receive(noise);
  REQUIRE(problem);
  CHECK(pieces <= 18);
}

TEST_CASE("a hello keeps known lines and skips others") {
  const TunnelHello hello =
      parse_hello("protocols 1 2 x 9999999999\nversion 3.1 beta\ncolour red\nfeatures http zip\n\n");
  CHECK(hello.protocols == std::vector<unsigned>{1, 2});
  CHECK(hello.version == "3.1 beta");
  CHECK(hello.features == std::vector<std::string>{"http", "zip"});
  CHECK(parse_hello(hello_text(hello)).protocols == hello.protocols);
  CHECK(parse_hello("").protocols.empty());
}

}  // namespace gs::net::tunnel_frames_test
