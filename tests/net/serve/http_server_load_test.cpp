#include "net/serve/http_server.h"

#include "tests/net/resident_memory.h"
#include "tests/net/served_site.h"
#include "tests/watched.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include <poll.h>
#include <sys/resource.h>

using namespace gs::net;
using namespace gs::net::test;

namespace {

const std::string kAsk = "GET /big HTTP/1.1\r\nHost: localhost\r\n\r\n";

}  // namespace

TEST_CASE("HTTP server: 200 clients share a rate fairly and in bounded memory", "[optimised]") {
  ServedSite site;
  site.write("big", std::string(std::size_t{32} << 20, 'x'));
  site.options.limits.total_rate = 40'000'000;
  site.options.limits.connections_of_client = 4;
  site.start();
  const std::size_t before = resident();
  std::vector<std::unique_ptr<RawClient>> clients;
  std::vector<pollfd> polls;
  // Keeps the system's buffers small relative to each client's data, so that the counts measure the server.
  for (int i = 0; i < 200; ++i) {
    const std::string from = "127.0." + std::to_string(1 + i / 100) + "." + std::to_string(1 + i % 100);
    clients.push_back(std::make_unique<RawClient>(site.port, from.c_str(), 16384));
    polls.push_back({clients.back()->socket(), POLLIN, 0});
    clients.back()->send(kAsk);
  }
  // Counting starts when all clients have started, because early clients get more on a busy machine.
  std::vector<std::size_t> got(clients.size());
  std::size_t begun = 0, total = 0, most_memory = 0;
  while (begun < clients.size() || total < std::size_t{400'000} * clients.size()) {
    REQUIRE(::poll(polls.data(), polls.size(), 60'000) > 0);
    const bool counted = begun == clients.size();
    for (std::size_t i = 0; i < polls.size(); ++i) {
      if ((polls[i].revents & POLLIN) == 0) continue;
      const std::size_t bytes = clients[i]->receive().size();
      REQUIRE(bytes > 0);
      begun += got[i] == 0 ? 1 : 0;
      got[i] += bytes;
      total += bytes;
    }
    if (!counted && begun == clients.size()) {
      got.assign(got.size(), 1);  // resets all counts
      total = 0;
    }
    most_memory = std::max(most_memory, resident());
  }
  const auto [least, most] = std::minmax_element(got.begin(), got.end());
  INFO("least " << *least << " most " << *most << " memory " << (most_memory - before));
  CHECK(*most <= *least * 2);
  CHECK(site.server->statistics().connections == 200);
  if (!gs::watched()) CHECK(most_memory - before < 200 * std::size_t{150'000});
}

TEST_CASE("HTTP server: gives an address with many connections the share of one") {
  ServedSite site;
  site.write("big", std::string(std::size_t{32} << 20, 'x'));
  site.options.limits.total_rate = 8'000'000;
  site.start();
  std::vector<std::unique_ptr<RawClient>> clients;
  std::vector<pollfd> polls;
  for (int i = 0; i < 17; ++i) {
    clients.push_back(std::make_unique<RawClient>(site.port, i == 0 ? "127.0.0.2" : "127.0.0.3", 16384));
    polls.push_back({clients.back()->socket(), POLLIN, 0});
    clients.back()->send(kAsk);
  }
  std::size_t alone = 0, others = 0;
  while (alone + others < 16'000'000) {
    REQUIRE(::poll(polls.data(), polls.size(), 60'000) > 0);
    for (std::size_t i = 0; i < polls.size(); ++i)
      if ((polls[i].revents & POLLIN) != 0) (i == 0 ? alone : others) += clients[i]->receive().size();
  }
  // The buffers of 16 connections still hold part of the others' data.
  CHECK(alone * 2 > others);
  CHECK(others * 2 > alone);
}

TEST_CASE("HTTP server: limits connections and requests of one client") {
  ServedSite site;
  site.write("a", "a");
  site.options.limits.connections_of_client = 2;
  site.options.limits.requests_per_second = 5;
  site.start();
  {
    RawClient one(site.port), two(site.port);
    one.send("GET /a HTTP/1.1\r\nHost: localhost\r\n\r\n");
    CHECK(one.receive().starts_with("HTTP/1.1 200"));
    two.send("GET /a HTTP/1.1\r\nHost: localhost\r\n\r\n");
    CHECK(two.receive().starts_with("HTTP/1.1 200"));
    RawClient three(site.port);
    three.send("GET /a HTTP/1.1\r\nHost: localhost\r\n\r\n");
    CHECK(three.receive().empty());
    RawClient other(site.port, "127.0.0.9");
    other.send("GET /a HTTP/1.1\r\nHost: localhost\r\n\r\n");
    CHECK(other.receive().starts_with("HTTP/1.1 200"));
  }
  RawClient busy(site.port, "127.0.0.7");
  std::string requests;
  for (int i = 0; i < 200; ++i) requests += "GET /a HTTP/1.1\r\nHost: localhost\r\n\r\n";
  busy.send(requests + "GET /a HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  const std::string all = busy.receive_all();
  CHECK(all.find("HTTP/1.1 429") != std::string::npos);
  CHECK(all.find("Retry-After: 1") != std::string::npos);
  CHECK(site.server->statistics().refused == 1);
}

TEST_CASE("HTTP server: gives up slow and overlong requests") {
  ServedSite site;
  site.write("big", std::string(std::size_t{32} << 20, 'x'));
  site.options.request_timeout = std::chrono::milliseconds(300);
  site.options.send_timeout = std::chrono::milliseconds(300);
  site.start();
  RawClient silent(site.port), slow(site.port), deaf(site.port, "127.0.0.1", 4096);
  deaf.send(kAsk);
  slow.send("GET /big HT");
  CHECK(silent.receive().empty());
  // A single byte now and then does not keep a connection open.
  bool closed = false;
  while (!closed) {
    slow.send("x");
    pollfd wait{slow.socket(), POLLIN, 0};
    closed = ::poll(&wait, 1, 20) > 0 && slow.receive().find("200 OK") == std::string::npos;
  }
  while (site.server->statistics().connections > 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(deaf.receive_all().size() < std::size_t{32} << 20);
  RawClient large(site.port);
  large.send("GET /big HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(100'000, 'x') + "\r\n\r\n");
  const std::string answer = large.receive_all();
  CHECK((answer.empty() || answer.starts_with("HTTP/1.1 431") || answer.starts_with("HTTP/1.1 413")));
  RawClient many(site.port);
  std::string headers;
  for (int i = 0; i < 20'000; ++i) headers += "X" + std::to_string(i) + ": y\r\n";
  many.send("GET /big HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n");
  const std::string refused = many.receive_all();
  CHECK((refused.empty() || refused.starts_with("HTTP/1.1 4")));
  RawClient body(site.port);
  body.send("GET /big HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000000\r\n\r\n");
  (void)body.receive_all();
  CHECK(site.get("/health").status == 200);
}

TEST_CASE("HTTP server: lets transfers end at a stop, and cuts them at the deadline") {
  for (const bool patient : {true, false}) {
    ServedSite site;
    site.write("big", std::string(std::size_t{8} << 20, 'x'));
    site.options.limits.total_rate = patient ? 20'000'000 : 1'000'000;
    site.start();
    RawClient busy(site.port), idle(site.port);
    idle.send("GET /health HTTP/1.1\r\nHost: localhost\r\n\r\n");
    REQUIRE(idle.receive().starts_with("HTTP/1.1 200"));
    busy.send(kAsk);
    std::string first = busy.receive();
    REQUIRE(first.starts_with("HTTP/1.1 200"));
    std::thread stop([&] { site.server->stop(std::chrono::milliseconds(patient ? 60'000 : 1)); });
    const std::size_t size = first.size() + busy.receive_all().size();
    CHECK((size > std::size_t{8} << 20) == patient);
    CHECK(idle.receive_all().size() < 8);  // the rest of its response
    stop.join();
    CHECK(site.get("/health").code == CURLE_COULDNT_CONNECT);
  }
}

TEST_CASE("HTTP server: truncates the response if the file changes while it is sent") {
  ServedSite site;
  site.write("big", std::string(std::size_t{8} << 20, 'x'));
  site.options.limits.total_rate = 1'000'000;
  site.start();
  RawClient client(site.port);
  client.send(kAsk);
  std::size_t size = client.receive().size();
  site.write("big", std::string(std::size_t{8} << 20, 'y'));
  const std::string rest = client.receive_all();
  CHECK(size + rest.size() < std::size_t{8} << 20);
  CHECK(rest.find('y') == std::string::npos);
}

TEST_CASE("HTTP server: makes a file once for all clients that wait for it") {
  ServedSite site;
  site.write("a.stl", "mesh");
  site.write("bad.stl", "bad");
  site.write("leak.stl", "leak");
  const std::string place = site.path("");
  site.options.made_folder = site.made();
  std::mutex mutex;
  std::condition_variable changed;
  bool open = false;
  std::atomic<int> made{0};
  std::atomic<bool> full{false};
  std::string reported;
  site.options.report = [&](const std::string& message) {
    const std::lock_guard lock(mutex);
    reported += message + "\n";
  };
  Maker maker;
  maker.name = "encode";
  maker.type.mime = "model/x-qnv";
  maker.extension = ".qnv";
  maker.for_missing = true;
  maker.source_of = [](const std::string& name, const std::string&) -> std::optional<std::string> {
    if (!name.ends_with(".stl.qnv")) return std::nullopt;
    return name.substr(0, name.size() - 4);
  };
  maker.make = [&](const std::string& source, const std::string& out,
                   const std::stop_token&) -> std::optional<MakeFailure> {
    if (source.ends_with("bad.stl")) return MakeFailure{source + " is no mesh"};
    if (source.ends_with("leak.stl")) return MakeFailure{"cannot open /etc/passwd"};
    if (full) return MakeFailure{"cannot write " + out + ": No space left on device", false};
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return open; });
    ++made;
    std::ofstream(out) << "stream of " << std::filesystem::path(source).filename().string();
    return std::nullopt;
  };
  site.options.makers.push_back(maker);
  site.start();
  CHECK(site.get("/nothing.stl.qnv").status == 404);
  const Got early = site.get("/a.stl.qnv", {"Range: bytes=0-5"});
  CHECK(early.status == 503);
  CHECK(early.headers.at("retry-after") == "2");
  CHECK(site.get("/a.stl.qnv", {}, "HEAD").status == 202);
  std::vector<std::thread> threads;
  std::atomic<int> good{0};
  for (int i = 0; i < 8; ++i)
    threads.emplace_back([&] {
      const std::string ask = "GET /a.stl.qnv HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
      RawClient client(site.port);
      client.send(ask);
      if (client.receive_all().ends_with("\r\n\r\nstream of a.stl")) ++good;
    });
  while (site.server->statistics().transfers < 8) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK(site.get("/health").status == 200);
  {
    const std::lock_guard lock(mutex);
    open = true;
  }
  changed.notify_all();
  for (std::thread& thread : threads) thread.join();
  CHECK(good == 8);
  const Got range = site.get("/a.stl.qnv", {"Range: bytes=0-5"});
  CHECK(range.status == 206);
  CHECK(range.body == "stream");
  CHECK(range.headers.at("content-type") == "model/x-qnv");
  CHECK(made == 1);
  site.write("a.stl", "another mesh");
  CHECK(site.get("/a.stl.qnv").body == "stream of a.stl");
  CHECK(made == 2);
  const Got bad = site.get("/bad.stl.qnv");
  CHECK(bad.status == 422);
  CHECK(bad.body == "cannot be generated: bad.stl is no mesh\n");
  const Got leak = site.get("/leak.stl.qnv");
  CHECK(leak.status == 422);
  CHECK(leak.body == "cannot be generated: it cannot be read; the server's log has the reason\n");
  // A full disk is not an error of the file. The server retries, and no client sees the path.
  full = true;
  site.write("a.stl", "a third mesh");
  const Got none = site.get("/a.stl.qnv");
  CHECK(none.status == 503);
  CHECK(none.headers.count("retry-after") == 1);
  CHECK(none.body.find('/') == std::string::npos);
  full = false;
  Got again = site.get("/a.stl.qnv");
  while (again.status == 503) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    again = site.get("/a.stl.qnv");
  }
  CHECK(again.body == "stream of a.stl");
  {
    const std::lock_guard lock(mutex);
    CHECK(reported.find("encode of " + place + "bad.stl failed: " + place + "bad.stl is no mesh\n") !=
          std::string::npos);
    CHECK(reported.find("No space left on device") != std::string::npos);
  }
  CHECK(site.get("/metrics").body.find("ghostspace_made_total{kind=\"encode\"} 3\n") != std::string::npos);
}
