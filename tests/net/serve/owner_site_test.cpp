// Tests of a server that serves an account to its owner, over connected sockets. docs/security.md names these tests.
#include "net/serve/http_server.h"
#include "net/serve/http_site.h"
#include "net/tunnel/socket_pump.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>

#include <poll.h>
#include <unistd.h>

namespace gs::net::owner_site_test {
namespace {

namespace fs = std::filesystem;

struct OwnerSample {
  ScratchFolder folder;
  HttpServerOptions options;
  OwnerSample() {
    folder.write("home/run/a.txt", "contents");
    folder.write("home/.hidden/b.txt", "hidden");
    folder.write("other/secret.txt", "secret");
    fs::create_symlink(folder.path("other/secret.txt"), folder.path("home/run/out.txt"));
    fs::create_symlink(folder.path("home"), folder.path("way"));
    fs::create_symlink("a.txt", folder.path("home/run/in.txt"));
    options.folder = "/";
    options.bind = "*";
    options.listen = false;
    options.to_owner = true;
    options.home = folder.path("home");
  }
};

std::string text_of_answer(const HttpAnswer& answer) {
  std::string text;
  for (const AnswerPart& part : answer.parts) {
    text += part.text;
    if (!part.text.empty() || !answer.file) continue;
    std::string piece(part.range.end - part.range.begin, '\0');
    piece.resize(static_cast<std::size_t>(std::max<ssize_t>(
        0, ::pread(answer.file->get(), piece.data(), piece.size(), static_cast<off_t>(part.range.begin)))));
    text += piece;
  }
  return text;
}

}  // namespace

TEST_CASE("follows links out of a folder only for the owner of an account") {
  OwnerSample sample;
  const HttpSite site(sample.options, std::get<ServedFolder>(ServedFolder::open("/", true, true)), nullptr,
                      [] { return std::string(); });
  const auto get = [&](const std::string& target, const std::string& within = {}) {
    HttpRequest request;
    request.method = "GET";
    request.target = target;
    request.within = within;
    request.hosts = {"localhost"};
    const auto reply = site.answer(request);
    const auto& answer = std::get<HttpAnswer>(reply);
    return std::to_string(answer.status) + " " + text_of_answer(answer);
  };
  const std::string home = sample.folder.path("home"), run = home + "/run/";
  CHECK(get(run + "a.txt") == "200 contents");
  CHECK(get("/~/run/a.txt") == "200 contents");
  CHECK(get(sample.folder.path("way/run/a.txt")) == "200 contents");
  CHECK(get(home + "/.hidden/b.txt") == "200 hidden");
  CHECK(get(run + "out.txt") == "200 secret");
  CHECK(get(run + "out.txt", run).starts_with("404 "));
  CHECK(get(run + "in.txt", run) == "200 contents");
  CHECK(get("/~/run/in.txt", "/~/run/") == "200 contents");
  CHECK(get("/~/run/out.txt", "/~/run/").starts_with("404 "));
  // The folder of the document may be a link itself.
  CHECK(get(sample.folder.path("way/run/a.txt"), sample.folder.path("way/")) == "200 contents");
  CHECK(get(sample.folder.path("other/secret.txt"), run).starts_with("403 "));
  CHECK(get(run + "a.txt", home + "/ru/").starts_with("403 "));
  CHECK(get(run + "a.txt", "no path").starts_with("403 "));
  CHECK(get(run + "%2e%2e/run/a.txt").starts_with("400 "));
  CHECK(get("/dev/null").starts_with("404 "));
}

TEST_CASE("a server without a port serves the sockets that it gets") {
  OwnerSample sample;
  auto started = HttpServer::start(std::move(sample.options));
  if (const auto* problem = std::get_if<HttpServerError>(&started)) FAIL(problem->message);
  HttpServer& server = *std::get<std::unique_ptr<HttpServer>>(started);
  CHECK(server.port() == 0);
  auto [ours, theirs] = socket_pair();
  REQUIRE(ours);
  server.adopt(std::move(theirs));
  for (int i = 0; i < 2; ++i) {  // twice on one connection
    const std::string request = "GET /~/run/a.txt HTTP/1.1\r\nHost: localhost\r\nRange: bytes=2-4\r\n\r\n";
    REQUIRE(::write(ours.get(), request.data(), request.size()) == static_cast<ssize_t>(request.size()));
    std::string answer;
    for (int tries = 0; tries < 100 && !answer.ends_with("\r\n\r\nnte"); ++tries) {
      pollfd wait{ours.get(), POLLIN, 0};
      (void)::poll(&wait, 1, 100);
      char block[4096];
      if (const ssize_t got = ::read(ours.get(), block, sizeof block); got > 0)
        answer.append(block, static_cast<std::size_t>(got));
    }
    CHECK(answer.starts_with("HTTP/1.1 206"));
    CHECK(answer.ends_with("\r\n\r\nnte"));
  }
  server.stop(std::chrono::milliseconds(0));
}

}  // namespace gs::net::owner_site_test
