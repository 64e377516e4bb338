#include "net/ssh/sftp_site.h"
#include "memory_sftp.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <string>
#include <utility>

namespace gs::net::sftp_site_test {
namespace {

using Time = Multiplexer::Time;

std::string big_text() {
  std::string text;
  while (text.size() < 3'000'000) text += std::to_string(text.size()) + " ";
  return text;
}

struct Place {
  test::MemorySftp server;
  SftpSite site{Time{}};
  std::size_t piece = 1 << 20;  // bytes of the server per call
  Place() {
    server.files = {{"/data/a.txt", "0123456789"}, {"/data/", ""},          {"/data/sub/", ""},
                    {"/data/secret.txt", "x"},     {"/data/empty.txt", ""}, {"/home/user/h.txt", "home"},
                    {"/home/user/", ""},           {"/etc/key", "private"}, {"/", ""}};
    server.links = {{"/data/link", "/etc/key"}, {"/data/near", "/data/a.txt"}};
    turn();
  }
  void turn() {
    for (int idle = 0; idle < 2;) {
      const auto bytes = site.outgoing();
      server.receive(bytes);
      site.sent(bytes.size());
      const std::vector<std::byte> answers = std::exchange(server.out, {});
      for (std::size_t at = 0; at < answers.size(); at += piece) {
        const auto problem = site.receive(std::span(answers).subspan(at, std::min(piece, answers.size() - at)), Time{});
        if (problem) FAIL(*problem);
      }
      idle = answers.empty() ? idle + 1 : 0;
    }
  }
  /// Returns the complete answer to a request.
  std::string get(const std::string& target, const std::string& fields = {}, const std::string& method = "GET") {
    const auto id = site.open();
    const std::string request = method + " " + target + " HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n";
    site.send(id, std::as_bytes(std::span(request)));
    std::string all;
    for (int i = 0; i < 1000; ++i) {
      turn();
      const auto got = site.received(id);
      if (got.empty()) break;
      all.append(reinterpret_cast<const char*>(got.data()), got.size());
      site.took(id, got.size());
    }
    site.close(id);
    turn();
    return all;
  }
};

std::string body(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? std::string() : answer.substr(end + 4);
}
bool has(const std::string& answer, const std::string& part) { return answer.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("an SFTP site answers requests for files, ranges and versions") {
  Place place;
  REQUIRE(place.site.ready());
  const std::string whole = place.get("/data/a.txt");
  CHECK(whole.starts_with("HTTP/1.1 200 OK\r\n"));
  CHECK(has(whole, "Content-Length: 10\r\n"));
  CHECK(has(whole, "Accept-Ranges: bytes\r\n"));
  CHECK(body(whole) == "0123456789");
  const std::string part = place.get("/data/a.txt", "Range: bytes=2-4\r\n");
  CHECK(has(part, "206 Partial Content"));
  CHECK(has(part, "Content-Range: bytes 2-4/10\r\n"));
  CHECK(body(part) == "234");
  const std::size_t tag = whole.find("ETag: ") + 6;
  const std::string etag = whole.substr(tag, whole.find("\r\n", tag) - tag);
  CHECK(has(place.get("/data/a.txt", "If-None-Match: " + etag + "\r\n"), "HTTP/1.1 304"));
  CHECK(body(place.get("/data/a.txt", "Range: bytes=2-4\r\nIf-Range: \"other\"\r\n")) == "0123456789");
  CHECK(body(place.get("/data/a.txt", "range:bytes=8-\r\nIF-RANGE:  " + etag + "\r\n")) == "89");
  CHECK(has(place.get("/data/a.txt", "Range: bytes=10-\r\n"), "HTTP/1.1 416"));
  CHECK(body(place.get("/data/a.txt", {}, "HEAD")).empty());
  CHECK(has(place.get("/data/empty.txt"), "Content-Length: 0\r\n"));
  CHECK(has(place.get("/data/a.txt", {}, "POST"), "HTTP/1.1 405"));
  CHECK(body(place.get("/~/h.txt")) == "home");
  CHECK(has(place.get("/data/none"), "HTTP/1.1 404"));
  CHECK(has(place.get("/data/secret.txt"), "HTTP/1.1 403"));
  CHECK(has(place.get("/data/%2e%2e/etc/key"), "HTTP/1.1 400"));
  CHECK(has(place.get("/data/a.txt/"), "HTTP/1.1 404"));
  // Each open file was closed.
  CHECK(std::count(place.server.asked.begin(), place.server.asked.end(), 3) ==
        std::count(place.server.asked.begin(), place.server.asked.end(), 4));
}

TEST_CASE("an SFTP site joins answers of any size and order of a long file") {
  Place place;
  place.server.files["/data/big"] = big_text();
  for (const std::uint32_t most : {32768u, 1000u}) {
    place.server.most = most;
    CHECK(body(place.get("/data/big")) == big_text());
    CHECK(body(place.get("/data/big", "Range: bytes=100000-1999999\r\n")) == big_text().substr(100000, 1900000));
  }
  place.piece = 777;
  CHECK(body(place.get("/data/big", "Range: bytes=5-70000\r\n")) == big_text().substr(5, 69996));
}

TEST_CASE("an SFTP site requests only as much as its client takes") {
  Place place;
  place.server.files["/data/big"] = big_text();
  const auto id = place.site.open();
  const std::string request = "GET /data/big HTTP/1.1\r\n\r\n";
  place.site.send(id, std::as_bytes(std::span(request)));
  place.turn();
  CHECK(place.site.received(id).size() <= (1 << 20) + 70'000);
  place.site.close(id);
  place.turn();
  CHECK(std::count(place.server.asked.begin(), place.server.asked.end(), 4) == 1);
}

TEST_CASE("an SFTP site lists folders") {
  Place place;
  CHECK(has(place.get("/data"), "Location: /data/\r\n"));
  const std::string list = body(place.get("/data/"));
  CHECK(has(list, "\"a.txt\""));
  CHECK(has(list, "\"./sub/\""));
  CHECK(has(list, "\"complete\": true"));
}

TEST_CASE("links do not lead an SFTP site out of a document's folder") {
  Place place;
  CHECK(body(place.get("/data/link")) == "private");
  CHECK(has(place.get("/data/link", "GhostSpace-Within: /data/\r\n"), "HTTP/1.1 403"));
  CHECK(body(place.get("/data/near", "GhostSpace-Within: /data/\r\n")) == "0123456789");
  CHECK(has(place.get("/etc/key", "GhostSpace-Within: /data/\r\n"), "HTTP/1.1 403"));
  CHECK(has(place.get("/data/a.txt", "GhostSpace-Within: /none/\r\n"), "HTTP/1.1 403"));
  CHECK(has(place.get("/data/none", "GhostSpace-Within: /data/\r\n"), "HTTP/1.1 404"));
}

TEST_CASE("a file that becomes shorter ends its connection") {
  Place place;
  place.server.files["/data/big"] = std::string(200'000, 'x');
  const auto id = place.site.open();
  const std::string request = "GET /data/big HTTP/1.1\r\n\r\n";
  place.site.send(id, std::as_bytes(std::span(request)));
  // Up to the answer of the size.
  for (int i = 0; i < 3; ++i) {
    const auto bytes = place.site.outgoing();
    place.server.receive(bytes);
    place.site.sent(bytes.size());
    const auto answers = std::exchange(place.server.out, {});
    REQUIRE_FALSE(place.site.receive(answers, Time{}));
  }
  place.server.files["/data/big"] = "short";
  place.turn();
  CHECK(place.site.ended(id));
  CHECK(place.site.received(id).size() < 200'000);
}

TEST_CASE("hostile SFTP servers end the connection, and hold little") {
  const auto refused = [](const std::vector<std::byte>& bytes) {
    SftpClient client;
    return client.receive(bytes).has_value();
  };
  const auto packet = [](std::initializer_list<int> numbers) {
    std::vector<std::byte> bytes;
    for (const int number : numbers) bytes.push_back(static_cast<std::byte>(number));
    return bytes;
  };
  CHECK(refused(packet({'W', 'e', 'l', 'c', 'o', 'm', 'e'})));
  CHECK(refused(packet({0, 0, 0, 0})));
  CHECK(refused(packet({0, 0, 0, 5, 2, 0, 0, 0, 2})));
  CHECK(refused(packet({0, 0, 0, 5, 101, 0, 0, 0, 3})));
  CHECK_FALSE(refused(packet({0, 0, 0, 5, 2, 0, 0, 0, 3})));
  CHECK(refused(packet({0, 0, 0, 5, 2, 0, 0, 0, 3, 0, 0, 0, 5, 101, 0, 0, 0, 1})));
  // Any changed byte of a session is an error, a failure of the request or another content, and never a crash.
  Place place;
  std::vector<std::byte> good;
  {
    const auto id = place.site.open();
    const std::string request = "GET /data/a.txt HTTP/1.1\r\nGhostSpace-Within: /data/\r\n\r\n";
    place.site.send(id, std::as_bytes(std::span(request)));
    for (int i = 0; i < 8; ++i) {
      const auto bytes = place.site.outgoing();
      place.server.receive(bytes);
      place.site.sent(bytes.size());
      good.insert(good.end(), place.server.out.begin(), place.server.out.end());
      REQUIRE_FALSE(place.site.receive(std::exchange(place.server.out, {}), Time{}));
    }
  }
  std::mt19937 random(2);
  for (int i = 0; i < 4000; ++i) {
    std::vector<std::byte> bad = good;
    bad[static_cast<std::size_t>(i) % bad.size()] ^= std::byte(1u << (random() % 8));
    if (i % 3 == 0) bad.resize(random() % bad.size());
    SftpSite site{Time{}};
    const auto id = site.open();
    const std::string request = "GET /data/a.txt HTTP/1.1\r\nGhostSpace-Within: /data/\r\n\r\n";
    const auto version = packet({0, 0, 0, 5, 2, 0, 0, 0, 3});
    (void)site.receive(version, Time{});
    site.send(id, std::as_bytes(std::span(request)));
    (void)site.receive(bad, Time{});
    CHECK(site.received(id).size() < 10'000);
  }
}

TEST_CASE("a silent SFTP server is given up") {
  SftpSite site{Time{}};
  CHECK_FALSE(site.deadline());
  const auto version = std::vector<std::byte>{std::byte{0}, std::byte{0}, std::byte{0}, std::byte{5}, std::byte{2},
                                              std::byte{0}, std::byte{0}, std::byte{0}, std::byte{3}};
  REQUIRE_FALSE(site.receive(version, Time{}));
  const auto id = site.open();
  const std::string request = "GET /a HTTP/1.1\r\n\r\n";
  site.send(id, std::as_bytes(std::span(request)));
  REQUIRE(site.deadline());
  CHECK_FALSE(site.step(Time{} + std::chrono::seconds(59)));
  CHECK(site.step(Time{} + std::chrono::seconds(60)));
}

}  // namespace gs::net::sftp_site_test
