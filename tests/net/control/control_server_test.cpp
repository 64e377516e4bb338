#include "net/control/control_server.h"
#include "base/noncopyable.h"
#include "masked_frames.h"
#include "net/control/control_token.h"
#include "tests/app/scratch_folder.h"
#include "tests/net/http_client.h"
#include "tests/net/resident_memory.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

namespace gs::net::control_server_test {
namespace {

using test::masked_frame;
using test::opening;
using test::RawClient;

const std::string kToken = "0123456789abcdef0123456789abcdef";

/// Client of a Unix socket.
class LineClient : public RawClient {
 public:
  explicit LineClient(const std::string& path, int receive_buffer = 0) : RawClient(AF_UNIX, receive_buffer) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    must(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0, "connect");
  }
  void say_no_more() const { ::shutdown(socket_, SHUT_WR); }
  [[nodiscard]] std::string line() {
    std::size_t end = 0;
    while ((end = kept_.find('\n')) == std::string::npos) {
      const std::string piece = receive();
      if (piece.empty()) return {};
      kept_ += piece;
    }
    const std::string one = kept_.substr(0, end);
    kept_.erase(0, end + 1);
    return one;
  }

 private:
  std::string kept_;
};

struct Served {
  explicit Served(const std::function<void(ControlServerOptions&)>& change = {}) {
    ControlServerOptions options;
    options.paths = {folder.path("socket")};
    options.ports = {0};
    options.terms.token = kToken;
    options.terms.farewell = [](const std::string& why) { return "BYE " + why; };
    if (change) change(options);
    auto started = ControlServer::start(std::move(options), [this] { ++wakes; });
    if (auto* problem = std::get_if<std::string>(&started)) FAIL(*problem);
    server = std::move(std::get<std::unique_ptr<ControlServer>>(started));
  }
  [[nodiscard]] std::string path() const { return folder.path("socket"); }
  [[nodiscard]] std::uint16_t port() const { return server->ports().front(); }
  /// Waits for the next event.
  ControlNews next() const {
    for (int i = 0; i < 20'000; ++i) {
      if (auto news = server->next()) return std::move(*news);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    FAIL("no news");
    return {};
  }
  template <class Condition>
  static void until(const Condition& condition) {
    for (int i = 0; i < 20'000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    REQUIRE(condition());
  }

  ScratchFolder folder;
  std::atomic<int> wakes = 0;
  std::unique_ptr<ControlServer> server;
};

}  // namespace

TEST_CASE("passes messages and answers by Unix socket and WebSocket and reports departures") {
  Served served;
  auto lines = std::make_unique<LineClient>(served.path());
  lines->send(kToken + "\nhello\n");
  const ControlNews first = served.next();
  CHECK(first.message == "hello");
  CHECK(served.wakes > 0);
  CHECK(served.server->send(first.client, "answer"));
  CHECK(lines->line() == "answer");
  RawClient frames(served.port());
  frames.send(opening("/?token=" + kToken) + masked_frame(0x81, "hello"));
  const ControlNews second = served.next();
  CHECK(second.message == "hello");
  CHECK(second.client != first.client);
  CHECK(served.server->send(second.client, "answer"));
  std::string got;
  while (
      !got.ends_with("\x81\x06"
                     "answer")) {
    const std::string piece = frames.receive();
    REQUIRE_FALSE(piece.empty());
    got += piece;
  }
  CHECK(got.starts_with("HTTP/1.1 101 "));
  lines.reset();
  const ControlNews left = served.next();
  CHECK(left.left);
  CHECK(left.client == first.client);
  Served::until([&] { return !served.server->send(first.client, "more"); });
}

TEST_CASE("answers all messages after the client has closed its side") {
  Served served;
  LineClient client(served.path());
  client.send(kToken + "\none\ntwo\n");
  client.say_no_more();
  for (const char* expected : {"one", "two"}) {
    const ControlNews news = served.next();
    CHECK(news.message == expected);
    CHECK(served.server->send(news.client, "to " + news.message));
  }
  CHECK(served.next().left);
  CHECK(client.receive_all() == "to one\nto two\n");
  Served::until([&] { return served.server->connections() == 0; });
}

TEST_CASE("sends the last answer and a goodbye before the server stops") {
  Served served;
  LineClient client(served.path());
  client.send(kToken + "\nquit\n");
  const ControlNews news = served.next();
  CHECK(served.server->send(news.client, "answer"));
  served.server.reset();
  CHECK(client.receive_all() == "answer\nBYE the program is ending\n");
}

TEST_CASE("restricts the socket to its owner, removes it at the end, and replaces a stale one") {
  Served served;
  struct stat about {};
  REQUIRE(::stat(served.path().c_str(), &about) == 0);
  CHECK((about.st_mode & 0777) == 0600);
  const auto start = [&](const std::string& path) {
    ControlServerOptions options;
    options.paths = {path};
    options.terms.token = kToken;
    return ControlServer::start(std::move(options), {});
  };
  const auto problem = [&](const std::string& path) {
    const auto started = start(path);
    const auto* why = std::get_if<std::string>(&started);
    return why ? *why : std::string();
  };
  CHECK(problem(served.path()) == served.path() + " is the socket of a running program");
  const std::string file = served.folder.write("file", "text");
  CHECK(problem(file) == file + " already exists and is not a socket; it is not replaced");
  CHECK(served.folder.read("file") == "text");
  CHECK(problem(std::string(200, 'x')).find("expected a path of 1 to 107 bytes") != std::string::npos);
  const std::string path = served.path();
  served.server.reset();
  CHECK(::stat(path.c_str(), &about) != 0);
  // A socket file as a killed program leaves it.
  const int dead = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  REQUIRE(::bind(dead, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  ::close(dead);
  CHECK(problem(path).empty());
}

TEST_CASE("listens on loopback only") {
  Served served;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(served.port());
  // Listens at 127.0.0.1 only.
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK + 1);
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  CHECK(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0);
  ::close(socket);
}

TEST_CASE("restricts the token file to its owner, and overwrites no other file") {
  ScratchFolder folder;
  const std::string path = folder.path("token");
  CHECK_FALSE(write_control_token(path, kToken));
  struct stat about {};
  REQUIRE(::stat(path.c_str(), &about) == 0);
  CHECK((about.st_mode & 0777) == 0600);
  CHECK(folder.read("token") == kToken + "\n");
  CHECK_FALSE(write_control_token(path, make_control_token()));
  CHECK(folder.read("token") != kToken + "\n");
  const std::string world = folder.write("world.wrl", "#VRML V2.0 utf8\n");
  CHECK(write_control_token(world, kToken) == world + " already exists and has no token; not overwritten");
  CHECK(folder.read("world.wrl") == "#VRML V2.0 utf8\n");
  CHECK(write_control_token(folder.path("no/folder"), kToken));
}

TEST_CASE("disconnects a client with a late or wrong token and gives the reason") {
  Served served([](ControlServerOptions& options) { options.terms.limits.admission = Instant(50'000); });
  LineClient silent(served.path());
  CHECK(silent.receive_all() == "BYE the token was not received in time\n");
  LineClient wrong(served.path());
  wrong.send(std::string(32, '0') + "\ncall\n");
  CHECK(wrong.receive_all() == "BYE wrong token\n");
  RawClient half(served.port());
  half.send("GET / HTTP/1.1\r\nHost: 127");
  CHECK(half.receive_all().empty());
  CHECK_FALSE(served.server->next());
}

TEST_CASE("admits a client while a thousand silent connections are open and bounds memory") {
  Served served([](ControlServerOptions& options) { options.terms.limits.strangers = 20; });
  std::vector<std::unique_ptr<LineClient>> crowd;
  [[maybe_unused]] const std::size_t before = test::resident();
  for (int i = 0; i < 1000; ++i) {
    // Limits the number of open descriptors.
    if (crowd.size() >= 200) crowd.erase(crowd.begin());
    crowd.push_back(std::make_unique<LineClient>(served.path()));
  }
  LineClient known(served.path());
  known.send(kToken + "\nhello\n");
  const ControlNews news = served.next();
  CHECK(news.message == "hello");
  CHECK(served.server->send(news.client, "answer"));
  CHECK(known.line() == "answer");
  CHECK(served.server->connections() <= 22);
  if (!watched()) CHECK(test::resident() < before + (std::size_t{32} << 20));  // AddressSanitizer keeps freed memory
}

TEST_CASE("admits no more clients than the limit, and tells the next one") {
  Served served([](ControlServerOptions& options) { options.terms.limits.clients = 2; });
  LineClient one(served.path()), two(served.path());
  one.send(kToken + "\na\n");
  CHECK(served.next().message == "a");
  two.send(kToken + "\nb\n");
  CHECK(served.next().message == "b");
  LineClient three(served.path());
  three.send(kToken + "\nc\n");
  CHECK(three.receive_all() == "BYE there are 2 clients already\n");
}

TEST_CASE("pauses reading from a client that floods, and serves the others in turn") {
  Served served([](ControlServerOptions& options) {
    options.terms.limits.waiting_messages = 100;
    options.terms.limits.waiting_bytes = 100'000;
  });
  [[maybe_unused]] const std::size_t before = test::resident();
  std::atomic<bool> done = false;
  constexpr int kMessages = 20'000;
  std::thread flood([&] {
    const LineClient client(served.path());
    client.send(kToken + "\n");
    std::string lines;
    for (int i = 0; i < kMessages; ++i) lines += std::to_string(i) + std::string(1000, ' ') + "\n";
    client.send(lines);
    done = true;
  });
  Served::until([&] { return served.server->connections() == 1; });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK_FALSE(done);  // 20 MB exceed the queue and the buffers of the system
  if (!watched()) CHECK(test::resident() < before + (std::size_t{64} << 20));  // AddressSanitizer keeps freed memory
  LineClient other(served.path());
  other.send(kToken + "\nother\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  int from_flood = 0;
  bool other_seen = false;
  while (!other_seen) {
    const ControlNews news = served.next();
    other_seen = news.message == "other";
    from_flood += other_seen ? 0 : 1;
  }
  CHECK(from_flood <= 200);
  int next = from_flood;
  bool in_order = true;
  while (next < kMessages) {
    const ControlNews news = served.next();
    if (news.left) continue;
    in_order = in_order && std::stoi(news.message) == next;
    ++next;
  }
  CHECK(in_order);
  flood.join();
  CHECK(done);
}

TEST_CASE("processes everything that a client sent before it closed, however long its queue is") {
  Served served([](ControlServerOptions& options) { options.terms.limits.waiting_messages = 10; });
  {
    const LineClient client(served.path());
    std::string lines = kToken + "\n";
    for (int i = 0; i < 1000; ++i) lines += std::to_string(i) + "\n";
    client.send(lines);
  }
  for (int i = 0; i < 1000; ++i) REQUIRE(served.next().message == std::to_string(i));
  CHECK(served.next().left);
}

TEST_CASE("disconnects a client that does not read, within bounded memory") {
  Served served([](ControlServerOptions& options) { options.terms.limits.outgoing_bytes = std::size_t{2} << 20; });
  LineClient client(served.path());
  client.send(kToken + "\nhello\n");
  const std::uint64_t number = served.next().client;
  CHECK_FALSE(served.server->is_behind(number));
  const std::string text(10'000, 'x');
  int sent = 0;
  while (!served.server->is_behind(number) && sent < 10'000) {
    REQUIRE(served.server->send(number, text));
    ++sent;
  }
  CHECK(served.server->is_behind(number));
  // A client that reads again receives the waiting messages. A wake reports that its queue has space.
  const int wakes = served.wakes;
  std::size_t got = 0;
  while (got < static_cast<std::size_t>(sent) * (text.size() + 1)) got += client.receive().size();
  Served::until([&] { return !served.server->is_behind(number); });
  Served::until([&] { return served.wakes > wakes; });
  for (sent = 0; served.server->send(number, text) && sent < 10'000; ++sent) {
  }
  CHECK(sent < 10'000);
  const ControlNews left = served.next();
  CHECK(left.left);
  CHECK(left.client == number);
}

}  // namespace gs::net::control_server_test
