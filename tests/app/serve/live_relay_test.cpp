#include "app/serve/live_relay.h"

#include "app/loading/updates/live_data.h"
#include "net/control/live_file.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <semaphore>
#include <string>
#include <thread>
#include <variant>

#include <netinet/in.h>
#include <sys/socket.h>

namespace gs::app::live_relay_test {
namespace {

using State = net::HeldContent::State;

/// Server of a simulation, and the file that names it.
struct RelayedRun {
  RelayedRun() {
    net::HttpServerOptions options;
    options.folder = folder.path("");
    options.list = [](const net::FolderListing&, const net::FolderRequest&) {
      return net::FolderPage{"model/vrml", "#VRML V2.0 utf8\n"};
    };
    options.content = [](const net::ContentRequest& request) -> net::HeldContent {
      if (request.path == "old.zarr/0/c.0.0.0") return {State::gone, {}, {}};
      if (request.path != "heat 1.zarr/0/c.0.0.0" && !request.path.starts_with("many.zarr/")) return {};
      return {State::ready, "application/octet-stream", "chunk"};
    };
    options.post = [this](const net::PostRequest& request) {
      posted = request.path + "?" + request.query + " " + request.authorization;
      return net::PostAnswer{200, "ok"};
    };
    auto started = net::HttpServer::start(std::move(options));
    REQUIRE(std::holds_alternative<std::unique_ptr<net::HttpServer>>(started));
    server = std::move(std::get<std::unique_ptr<net::HttpServer>>(started));
    REQUIRE_FALSE(net::write_live_file(file, {net::name_of_machine(), "127.0.0.1", server->port(), token}));
  }
  // Repeats a request to the relay until it has the content of a path below the file.
  [[nodiscard]] net::HeldContent get(const std::string& path, const std::string& within = {}) {
    for (int i = 0; i < 10'000; ++i) {
      net::HeldContent held = relay.content({file.substr(1) + path, within});
      if (held.state != State::waiting) return held;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return {};
  }

  // Changes parameters, and waits for the answer.
  [[nodiscard]] net::PostAnswer post(const std::string& path, const std::string& query) {
    net::PostAnswer answer = relay.post({file + path, query, "Bearer wrong"});
    for (int i = 0; answer.later && i < 10'000; ++i) {
      if (auto ready = answer.later()) return std::move(*ready);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return answer;
  }

  ScratchFolder folder;
  const std::string file = folder.path("run.live"), token = std::string(32, 'c');
  std::string posted;
  std::unique_ptr<net::HttpServer> server;
  LiveRelay relay{[] {}};
};

}  // namespace

TEST_CASE("ssh: paths below the file of a simulation are resources of its server") {
  const auto path = live_path("home/ann/run.live/a.zarr/zarr.json");
  REQUIRE(path);
  CHECK(path->file == "/home/ann/run.live");
  CHECK(path->resource == "a.zarr/zarr.json");
  CHECK(live_path("home/run.live/")->resource.empty());
  for (const char* other : {"", "run.live", "run.lively/a", ".live/a", "a/.live/a", "home/run.qnv"})
    CHECK_FALSE(live_path(other));
  CHECK(live_address("ssh://host/run.live") == "ssh://host/run.live/");
  CHECK(live_address("ssh://host/run.live/") == "ssh://host/run.live/");
  CHECK(live_address("http://host/run.live") == "http://host/run.live");
}

TEST_CASE("ssh: the server of a simulation is relayed through the file that names it") {
  RelayedRun run;
  CHECK(run.get("/").body == "#VRML V2.0 utf8\n");
  CHECK(run.get("/").mime == "model/vrml");
  CHECK(run.get("/heat 1.zarr/0/c.0.0.0").body == "chunk");
  CHECK(run.get("/other").state == State::none);
  CHECK(run.get("/old.zarr/0/c.0.0.0").state == State::gone);
  CHECK(run.get("/", run.file + "/").state == State::ready);
  // A document in the folder must not reach the servers that live files in that folder name.
  CHECK(run.get("/", run.folder.path("")).state == State::none);
  CHECK(run.relay.content({"home/none.live/", {}}).state == State::none);
}

TEST_CASE("ssh: requests that nobody waits for any more do not block others") {
  RelayedRun run;
  for (int i = 0; i < 64; ++i)
    CHECK(run.relay.content({run.file.substr(1) + "/many.zarr/" + std::to_string(i), {}}).state == State::waiting);
  CHECK(run.get("/heat 1.zarr/0/c.0.0.0").body == "chunk");
}

TEST_CASE("ssh: a simulation that does not answer a change does not block other requests") {
  RelayedRun run;
  // A socket that accepts connections in its queue, but never answers.
  const net::Descriptor silent(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  REQUIRE(::bind(silent.get(), reinterpret_cast<const sockaddr*>(&address), size) == 0);
  REQUIRE(::listen(silent.get(), 64) == 0);
  REQUIRE(::getsockname(silent.get(), reinterpret_cast<sockaddr*>(&address), &size) == 0);
  const std::string file = run.folder.path("silent.live");
  REQUIRE_FALSE(net::write_live_file(file, {net::name_of_machine(), "127.0.0.1", ntohs(address.sin_port), run.token}));
  const net::PostAnswer waits = run.relay.post({file + "/parameters", "feed=0.5", ""});
  REQUIRE(waits.later);
  CHECK_FALSE(waits.later());
  CHECK(run.get("/heat 1.zarr/0/c.0.0.0").body == "chunk");
  CHECK(run.post("/parameters", "feed=0.5").status == 200);
  CHECK_FALSE(waits.later());
  int refused = 0;
  for (int i = 0; i < 20; ++i) refused += run.relay.post({file + "/parameters", "feed=0.5", ""}).status == 503 ? 1 : 0;
  CHECK(refused > 0);
}

TEST_CASE("ssh: content is ready when the relay wakes the server") {
  RelayedRun run;
  std::binary_semaphore woken(0), seen(0);
  LiveRelay relay([&] {
    woken.release();
    seen.acquire();
  });
  const net::ContentRequest request{run.file.substr(1) + "/heat 1.zarr/0/c.0.0.0", {}};
  CHECK(relay.content(request).state == State::waiting);
  woken.acquire();
  CHECK(relay.content(request).body == "chunk");
  seen.release();
}

TEST_CASE("ssh: the relay does not follow a server to another one") {
  RelayedRun run, other;
  std::filesystem::create_directories(run.folder.path("folder"));
  CHECK(run.get("/folder").state == State::none);  // the server redirects to "folder/"
  CHECK(other.get("/").state == State::ready);
}

TEST_CASE("ssh: changes of parameters get the token of the file") {
  RelayedRun run;
  CHECK(run.post("/parameters", "feed=0.5").status == 200);
  CHECK(run.posted == "/parameters?feed=0.5 Bearer " + run.token);
  CHECK(run.relay.post({"/home/other", "feed=0.5", ""}).status == 405);
  CHECK(run.relay.post({"/home/none.live/parameters", "feed=0.5", ""}).status == 404);
}

}  // namespace gs::app::live_relay_test
