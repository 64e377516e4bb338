#include "net/serve/http_server.h"
#include "tests/app/scratch_folder.h"
#include "tests/net/http_client.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <variant>

namespace gs::net::http_content_test {
namespace {

using gs::net::test::fetch;
using State = HeldContent::State;

/// Server with content that is ready after a number of calls.
struct ContentServer {
  explicit ContentServer(std::chrono::milliseconds wait) {
    HttpServerOptions options;
    options.folder = folder.path("");
    options.content_wait = wait;
    options.content = [this](const ContentRequest& request) -> HeldContent {
      if (request.path == "full" || (request.path == "full later" && ready)) throw std::bad_alloc();
      if (request.path == "full later") return {State::waiting, {}, {}};
      if (request.path != "a b/c" && request.path != "a b/") return {};
      if (!ready) return {State::waiting, {}, {}};
      return {State::ready, "text/x-test", "content"};
    };
    auto started = HttpServer::start(std::move(options));
    REQUIRE(std::holds_alternative<std::unique_ptr<HttpServer>>(started));
    server = std::move(std::get<std::unique_ptr<HttpServer>>(started));
  }
  ScratchFolder folder;
  std::atomic<bool> ready{false};
  std::unique_ptr<HttpServer> server;
};

}  // namespace

TEST_CASE("a request waits for content that the program makes") {
  ContentServer made(std::chrono::seconds(60));
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    made.ready = true;
    made.server->wake();
  });
  const auto got = fetch(made.server->port(), "/a%20b/c");
  later.join();
  CHECK(got.status == 200);
  CHECK(got.body == "content");
  CHECK(got.headers.at("content-type") == "text/x-test");
  CHECK(fetch(made.server->port(), "/a%20b/c", {"If-None-Match: " + got.headers.at("etag")}).status == 304);
  CHECK(fetch(made.server->port(), "/a%20b/").body == "content");
  CHECK(fetch(made.server->port(), "/a%20b/d").status == 404);
}

TEST_CASE("a request for content that is not ready in time must be repeated") {
  ContentServer made(std::chrono::milliseconds(1));
  const auto got = fetch(made.server->port(), "/a%20b/c");
  CHECK(got.status == 503);
  CHECK(got.headers.contains("retry-after"));
  CHECK(fetch(made.server->port(), "/a%20b/c", {}, "HEAD").status == 202);
}

TEST_CASE("content that fails closes its connection, and the server goes on") {
  ContentServer made(std::chrono::seconds(60));
  CHECK(fetch(made.server->port(), "/full").status == 0);
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    made.ready = true;
    made.server->wake();
  });
  CHECK(fetch(made.server->port(), "/full%20later").status == 0);
  later.join();
  CHECK(fetch(made.server->port(), "/a%20b/c").body == "content");
}

TEST_CASE("a server stops while requests wait for content") {
  auto made = std::make_unique<ContentServer>(std::chrono::seconds(60));
  const auto port = made->server->port();
  long status = -1;
  std::thread client([port, &status] { status = fetch(port, "/a%20b/c").status; });
  while (made->server->statistics().transfers == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  made->server->stop(std::chrono::milliseconds(0));
  client.join();
  CHECK(status == 0);
}

}  // namespace gs::net::http_content_test
