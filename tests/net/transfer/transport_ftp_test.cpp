#include <catch2/catch.hpp>

#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/noncopyable.h"
#include "tests/net/http_client.h"
#include "tests/net/load_helpers.h"

/// Files by FTP (RFC 959; VRML97 Table 7-1), from a minimal server.
namespace {

using namespace gs::net;
using namespace gs::net::test;

int listen_on_loopback(std::uint16_t& port) {
  const int listener = bound_socket(port);
  REQUIRE(::listen(listener, 4) == 0);
  return listener;
}

/// Server of one file that answers one connection after another until it is destroyed.
class FtpServer : gs::NonCopyable {
 public:
  struct Ways {
    std::string file = "worlds/a.wrl";
    std::string text;
    bool tells_size = true;
    bool lets_in = true;
    std::size_t sent = std::string::npos;  // bytes of the text that it sends
    bool ends = true;                      // reports the end of the file, and says goodbye
  };

  explicit FtpServer(Ways ways) : ways_(std::move(ways)), listener_(listen_on_loopback(port_)) {
    thread_ = std::thread([this] {
      for (;;) {
        const int control = ::accept(listener_, nullptr, nullptr);
        if (control < 0) return;
        answer(control);
        ::close(control);
      }
    });
  }
  ~FtpServer() {
    ::shutdown(listener_, SHUT_RDWR);
    const int open = control_.load();
    if (open >= 0) ::shutdown(open, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }

  [[nodiscard]] std::string url(const std::string& path) const {
    return "ftp://127.0.0.1:" + std::to_string(port_) + "/" + path;
  }
  [[nodiscard]] std::vector<std::string> commands() {
    const std::lock_guard lock(mutex_);
    return commands_;
  }

 private:
  static void send(int socket, const std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t sent = ::send(socket, text.data() + at, text.size() - at, MSG_NOSIGNAL);
      if (sent <= 0) return;
      at += static_cast<std::size_t>(sent);
    }
  }

  void answer(int control) {
    control_ = control;
    send(control, "220 here\r\n");
    int data_listener = -1;
    std::uint16_t data_port = 0;
    std::string line;
    for (char c = 0; ::recv(control, &c, 1, 0) == 1;) {
      if (c != '\n') {
        if (c != '\r') line += c;
        continue;
      }
      {
        const std::lock_guard lock(mutex_);
        commands_.push_back(line);
      }
      const std::string command = line.substr(0, line.find(' '));
      const std::string argument = line.substr(std::min(line.size(), command.size() + 1));
      line.clear();
      if (command == "USER") {
        send(control, "331 who\r\n");
      } else if (command == "PASS") {
        send(control, ways_.lets_in ? "230 in\r\n" : "530 no\r\n");
      } else if (command == "PWD") {
        send(control, "257 \"/\"\r\n");
      } else if (command == "EPSV") {
        if (data_listener >= 0) ::close(data_listener);
        data_listener = listen_on_loopback(data_port);
        send(control, "229 Entering Extended Passive Mode (|||" + std::to_string(data_port) + "|)\r\n");
      } else if (command == "TYPE") {
        send(control, "200 so be it\r\n");
      } else if (command == "SIZE" && ways_.tells_size) {
        send(control, argument == ways_.file ? "213 " + std::to_string(ways_.text.size()) + "\r\n" : "550 none\r\n");
      } else if (command == "RETR" && argument == ways_.file) {
        send(control, "150 it comes\r\n");
        const int data = ::accept(data_listener, nullptr, nullptr);
        send(data, ways_.text.substr(0, ways_.sent));
        ::close(data);
        if (ways_.ends) send(control, "226 that was it\r\n");
      } else if (command == "QUIT") {
        if (ways_.ends) send(control, "221 farewell\r\n");
        if (ways_.ends) break;
      } else {
        send(control, command == "RETR" ? "550 none\r\n" : "502 what\r\n");
      }
    }
    if (data_listener >= 0) ::close(data_listener);
    control_ = -1;
  }

  Ways ways_;
  std::uint16_t port_ = 0;
  int listener_;
  std::atomic<int> control_{-1};
  std::mutex mutex_;
  std::vector<std::string> commands_;
  std::thread thread_;
};

LoaderOptions few_attempts() {
  LoaderOptions options;
  options.max_retries = 0;
  options.connect_timeout = Milliseconds(2000);
  return options;
}

Outcome load_from(FtpServer& server, const std::string& path, Origin from = {}) {
  const auto loader = Loader::create(few_attempts());
  Request request;
  request.url = server.url(path);
  request.from = std::move(from);
  return load(*loader, std::move(request));
}

TEST_CASE("ftp: reads a whole file in binary mode, over a passive connection (Table 7-1)") {
  const std::string text = pattern(300'000) + "\r\n\n";
  FtpServer server({.text = text});
  const Outcome got = load_from(server, "worlds/a.wrl#Front");
  INFO((got.error ? got.error->message : ""));
  CHECK(got.events == "Hd.");
  CHECK(got.text() == text);
  CHECK(got.head.total == text.size());
  CHECK(got.head.space == AddressSpace::loopback);
  CHECK_FALSE(got.head.accepts_ranges);
  const std::vector<std::string> commands = server.commands();
  REQUIRE(commands.size() > 2);
  CHECK(commands[0] == "USER anonymous");
  CHECK(std::count(commands.begin(), commands.end(), "TYPE I") == 1);
  CHECK(std::count(commands.begin(), commands.end(), "RETR worlds/a.wrl") == 1);
  for (const std::string& command : commands) CHECK(command.substr(0, 4) != "PORT");
}

TEST_CASE("ftp: cuts ranges out of the whole file") {
  const std::string text = pattern(5000);
  FtpServer server({.text = text});
  const auto loader = Loader::create(few_attempts());
  const Outcome got = load(*loader, ranges_of(server.url("worlds/a.wrl"), {{1000, 1200}, {4000, 4100}}));
  INFO((got.error ? got.error->message : ""));
  REQUIRE(got.done);
  REQUIRE(got.pieces.size() == 2);
  CHECK(got.pieces.at(1000) == text.substr(1000, 200));
  CHECK(got.pieces.at(4000) == text.substr(4000, 100));
}

TEST_CASE("ftp: reads an empty file") {
  FtpServer server({.text = ""});
  const Outcome got = load_from(server, "worlds/a.wrl");
  INFO((got.error ? got.error->message : ""));
  CHECK(got.done);
  CHECK(got.received == 0);
}

TEST_CASE("ftp: reports missing files, closed connections, short files and unknown lengths") {
  const auto message = [](FtpServer::Ways ways, const std::string& path, LoadErrorKind kind) {
    FtpServer server(std::move(ways));
    const Outcome got = load_from(server, path);
    REQUIRE(got.error);
    CHECK(got.error->kind == kind);
    return got.error->message;
  };
  CHECK_THAT(message({.text = "x"}, "worlds/b.wrl", LoadErrorKind::not_found), Catch::Contains("no such file"));
  CHECK_THAT(message({.text = "x", .lets_in = false}, "worlds/a.wrl", LoadErrorKind::http_status),
             Catch::Contains("user name and password"));
  CHECK_THAT(message({.text = "x", .tells_size = false}, "worlds/a.wrl", LoadErrorKind::bad_response),
             Catch::Contains("does not support SIZE"));
  CHECK_THAT(message({.text = pattern(5000), .sent = 1000}, "worlds/a.wrl", LoadErrorKind::broken),
             Catch::Contains("the connection was interrupted"));
}

TEST_CASE("ftp: returns without waiting for a server that is silent after the file") {
  const std::string text = pattern(5000);
  FtpServer server({.text = text, .ends = false});
  const Outcome got = load_from(server, "worlds/a.wrl");
  INFO((got.error ? got.error->message : ""));
  CHECK(got.text() == text);
}

TEST_CASE("ftp: applies the reference policy and refuses injected commands") {
  FtpServer server({.text = "x"});
  const Outcome foreign = load_from(server, "worlds/a.wrl", {"http://example.org/w.wrl", AddressSpace::global});
  REQUIRE(foreign.error);
  CHECK(foreign.error->kind == LoadErrorKind::forbidden);
  CHECK(server.commands().empty());
  CHECK(load_from(server, "worlds/a.wrl%0d%0aDELE%20b").error);
  for (const std::string& command : server.commands()) CHECK(command.substr(0, 4) != "DELE");
}

}  // namespace
