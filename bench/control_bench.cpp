// control_bench [NODES] [FRAMES]: measures a controlled program. Prints milliseconds per frame for events of NODES
// Transforms, read and applied, and with the render list; and microseconds until an event is answered, over a Unix
// socket and over a WebSocket.

#include "app/control/control.h"
#include "app/session/session.h"
#include "net/control/control_server.h"
#include "tests/app/control/queued_channel.h"
#include "vrml/syntax/parser.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace {

using namespace gs;
using namespace gs::app;
using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

class Pipe final : public QueuedChannel {
 public:
  void send(std::uint64_t, std::string message) override {
    if (message.find("\"error\"") != std::string::npos) std::printf("%s\n", message.c_str());
  }
};

class Server final : public ControlChannel {
 public:
  [[nodiscard]] std::optional<net::ControlNews> next() override { return server->next(); }
  void send(std::uint64_t client, std::string message) override { (void)server->send(client, std::move(message)); }
  [[nodiscard]] bool is_behind(std::uint64_t client) const override { return server->is_behind(client); }
  std::unique_ptr<net::ControlServer> server;
};

/// Session of one world, controlled through a channel.
struct Controlled {
  Controlled(ControlChannel& channel, const std::string& text, const std::function<void()>& wake)
      : session({{}, {}, {}, true}, {}, [] {}), control(channel, wake) {
    LoadedWorld world;
    world.scene = std::make_unique<vrml::SceneGraph>("bench.wrl");
    Diagnostics diagnostics;
    (void)vrml::parse("#VRML V2.0 utf8\n" + text, *world.scene, diagnostics);
    document = hold_world(std::move(world));
    begin_world(*document, now);
    session.readers().show(document);
    session.add_extension(control);
    input.area = Viewport{0, 0, 1024, 768};
    step();
  }
  ~Controlled() { session.remove_extension(control); }
  void step() { (void)session.step(now += 1.0 / 60, input); }

  double now = 1000;
  Session session;
  Control control;
  std::shared_ptr<Document> document;
  SessionInput input;
};

std::string world_of(int nodes) {
  std::string text;
  for (int i = 0; i < nodes; ++i)
    text += "DEF T" + std::to_string(i) + " Transform { children Shape { geometry Box {} } }\n";
  return text;
}

/// Returns a call that moves all nodes. It names the nodes by number or by DEF name.
std::string frame_of(int nodes, int frame, bool by_name, bool one_each) {
  std::string text = one_each ? "[" : "{\"jsonrpc\":\"2.0\",\"method\":\"setValues\",\"params\":{\"events\":[";
  for (int i = 0; i < nodes; ++i) {
    char value[160];
    const std::string node = by_name ? "\"T" + std::to_string(i) + "\"" : std::to_string(i + 1);
    std::snprintf(value, sizeof value, "[%.6f,%.6f,%.6f]", 0.001 * i, 0.01 * frame, 0.37 * ((i * 7 + frame) % 100));
    if (i) text += ',';
    if (one_each)
      text += "{\"jsonrpc\":\"2.0\",\"method\":\"setValue\",\"params\":{\"node\":" + node +
              ",\"event\":\"set_translation\",\"value\":" + value + "}}";
    else
      text += "[" + node + ",\"set_translation\"," + value + "]";
  }
  return text + (one_each ? "]" : "]}}");
}

void measure_apply(int nodes, int frames, bool by_name, bool one_each, bool looks) {
  Pipe pipe;
  Controlled world(pipe, world_of(nodes), [] {});
  for (int i = 0; i < nodes; ++i)
    pipe.news.push_back({1, false, "{\"method\":\"getNode\",\"params\":[\"T" + std::to_string(i) + "\"]}"});
  while (!pipe.news.empty()) world.step();
  world.input.look = looks;
  if (!looks) world.input.area.reset();
  std::vector<double> times;
  std::size_t bytes = 0;
  for (int i = 0; i < frames; ++i) {
    std::string text = frame_of(nodes, i, by_name, one_each);
    bytes = text.size();
    pipe.news.push_back({1, false, std::move(text)});
    const Clock::time_point start = Clock::now();
    while (!pipe.news.empty()) world.step();
    times.push_back(milliseconds_since(start));
  }
  std::printf("%-34s %-28s %7zu bytes %8.3f ms\n",
              one_each  ? "a setValue each, in one list"
              : by_name ? "setValues, by DEF names"
                        : "setValues, by numbers",
              looks ? "read, applied, list updated" : "read, applied", bytes, median(times));
}

// Measures reading the text into a tree, and a walk along the text without a tree.
void measure_readers(int nodes) {
  const std::string text = frame_of(nodes, 1, false, false);
  std::vector<double> trees, cursors;
  for (int i = 0; i < 200; ++i) {
    Clock::time_point start = Clock::now();
    const auto tree = nlohmann::json::parse(text);
    trees.push_back(milliseconds_since(start));
    start = Clock::now();
    double sum = check_json(text) ? 1 : 0;
    JsonCursor json(text);
    std::string made;
    json.open();
    while (json.more()) {
      if (json.name(made) != "params") {
        (void)json.skip();
        continue;
      }
      json.open();
      (void)json.more();
      (void)json.name(made);
      json.open();
      while (json.more()) {
        json.open();
        (void)json.more();
        sum += json.number();
        (void)json.more();
        (void)json.string(made);
        (void)json.more();
        json.open();
        while (json.more()) sum += json.number();
        (void)json.more();
      }
      (void)json.more();
    }
    cursors.push_back(milliseconds_since(start));
    if (sum == 0.125) std::printf(" ");
  }
  std::printf("%-34s %-28s %7zu bytes %8.3f ms\n", "the text alone", "checked, gone along", text.size(),
              median(cursors));
  std::printf("%-34s %-28s %7zu bytes %8.3f ms\n", "the text alone", "a tree of it (nlohmann)", text.size(),
              median(trees));
}

class EventFd {
 public:
  void ring() {
    const std::scoped_lock lock(mutex_);
    rung_ = true;
    condition_.notify_one();
  }
  void wait() {
    std::unique_lock lock(mutex_);
    condition_.wait(lock, [&] { return rung_; });
    rung_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable condition_;
  bool rung_ = false;
};

std::string masked(const std::string& text) {
  std::string frame = "\x81";
  const std::size_t size = text.size();
  const int bytes = size < 126 ? 0 : size < 65536 ? 2 : 8;
  frame += static_cast<char>(0x80 | (bytes == 0 ? size : bytes == 2 ? 126 : 127));
  for (int i = bytes - 1; i >= 0; --i) frame += static_cast<char>(size >> (8 * i) & 0xff);
  frame += std::string("\x11\x22\x33\x44");
  for (std::size_t i = 0; i < size; ++i) frame += static_cast<char>(text[i] ^ "\x11\x22\x33\x44"[i % 4]);
  return frame;
}

struct Client {
  int socket = -1;
  bool frames = false;
  void say(const std::string& text) const {
    const std::string bytes = frames ? masked(text) : text + "\n";
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t sent = ::send(socket, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (sent <= 0) return;
      at += static_cast<std::size_t>(sent);
    }
  }
  /// Receives bytes until they end in `end`; answers are short.
  void hear(const char* end) const {
    std::string all;
    char bytes[4096];
    while (!all.ends_with(end)) {
      const ssize_t got = ::recv(socket, bytes, sizeof bytes, 0);
      if (got <= 0) return;
      all.append(bytes, static_cast<std::size_t>(got));
    }
  }
};

void measure_sockets(int nodes, int frames, bool web) {
  const std::string path = "/tmp/ghostspace-control-bench-" + std::to_string(::getpid());
  net::ControlServerOptions options;
  options.terms.token = "token";
  if (web) {
    options.ports = {0};
  } else {
    options.paths = {path};
  }
  EventFd bell;
  Server server;
  auto started = net::ControlServer::start(std::move(options), [&] { bell.ring(); });
  if (!std::holds_alternative<std::unique_ptr<net::ControlServer>>(started)) return;
  server.server = std::move(std::get<std::unique_ptr<net::ControlServer>>(started));
  std::vector<double> times;
  double streamed = 0;
  std::atomic<bool> done = false;
  std::thread client([&] {
    Client own;
    own.frames = web;
    if (web) {
      own.socket = ::socket(AF_INET, SOCK_STREAM, 0);
      const int on = 1;
      ::setsockopt(own.socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      address.sin_port = htons(server.server->ports().front());
      (void)::connect(own.socket, reinterpret_cast<const sockaddr*>(&address), sizeof address);
      const std::string opening =
          "GET /?token=token HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
          "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n";
      (void)!::send(own.socket, opening.data(), opening.size(), 0);
      own.hear("\r\n\r\n");
    } else {
      own.socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
      sockaddr_un address{};
      address.sun_family = AF_UNIX;
      path.copy(address.sun_path, sizeof address.sun_path - 1);
      (void)::connect(own.socket, reinterpret_cast<const sockaddr*>(&address), sizeof address);
      own.say("token");
    }
    const char* const end = web ? "}}" : "}}\n";
    for (int i = 0; i < nodes; ++i) {
      own.say("{\"id\":1,\"method\":\"getNode\",\"params\":[\"T" + std::to_string(i) + "\"]}");
      own.hear(end);
    }
    for (int i = 0; i < 2000; ++i) {
      const Clock::time_point start = Clock::now();
      own.say("{\"id\":1,\"method\":\"setValue\",\"params\":[1,\"set_translation\",[1,2," + std::to_string(i) + "]]}");
      own.hear(end);
      times.push_back(milliseconds_since(start) * 1000);
    }
    const Clock::time_point start = Clock::now();
    for (int i = 0; i < frames; ++i) own.say(frame_of(nodes, i, false, false));
    own.say("{\"id\":1,\"method\":\"endUpdate\"}");
    own.hear(end);
    streamed = milliseconds_since(start) / frames;
    ::close(own.socket);
    done = true;
    bell.ring();
  });
  {
    Controlled world(server, world_of(nodes), [&] { bell.ring(); });
    world.input.area.reset();
    world.input.look = false;
    while (!done) {
      bell.wait();
      world.step();
    }
    client.join();
  }
  std::sort(times.begin(), times.end());
  std::printf("%-34s an event answered in %.0f us (99 of 100: %.0f us); %d events a frame streamed: %.3f ms a frame\n",
              web ? "WebSocket" : "Unix socket", times[times.size() / 2], times[times.size() * 99 / 100], nodes,
              streamed);
}

}  // namespace

int main(int argc, char** argv) {
  const int nodes = argc > 1 ? std::atoi(argv[1]) : 1000, frames = argc > 2 ? std::atoi(argv[2]) : 300;
  for (const bool looks : {false, true})
    for (const bool by_name : {false, true}) measure_apply(nodes, frames, by_name, false, looks);
  measure_apply(nodes, frames, false, true, false);
  measure_readers(nodes);
  for (const bool web : {false, true}) measure_sockets(nodes, frames, web);
  return 0;
}
