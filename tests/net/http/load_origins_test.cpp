// Tests of the hosts that a text may reach. docs/security.md names these tests.
#include <catch2/catch.hpp>

#include <atomic>
#include <fstream>
#include <string>

#include "net/http/http_cache.h"
#include "tests/net/bad_server.h"
#include "tests/net/load_helpers.h"

namespace {

using namespace gs::net;
using namespace gs::net::test;
using Exchange = BadServer::Exchange;

const Origin kPublic{"http://public.example/w.wrl", AddressSpace::global};

Request from(const Origin& origin, const std::string& url) {
  Request request;
  request.url = url;
  request.from = origin;
  return request;
}

MemoryAnswer answer_of(AddressSpace space, std::string_view text = "text") {
  MemoryAnswer answer;
  answer.head.space = space;
  answer.head.content_length = text.size();
  answer.body = bytes_of(text);
  return answer;
}

MemoryAnswer redirect(AddressSpace space, const std::string& to) {
  MemoryAnswer answer = answer_of(space, "");
  answer.head.status = 302;
  answer.head.location = to;
  return answer;
}

TEST_CASE("refuses references of a public document to local hosts even after redirects") {
  Bench bench;
  bench.network->put("memory://public/a", [](const auto&, unsigned) { return answer_of(AddressSpace::global); });
  bench.network->put("memory://inside/a", [](const auto&, unsigned) { return answer_of(AddressSpace::local); });
  bench.network->put("memory://public/in",
                     [](const auto&, unsigned) { return redirect(AddressSpace::global, "memory://inside/a"); });
  bench.network->put("memory://inside/out",
                     [](const auto&, unsigned) { return redirect(AddressSpace::local, "memory://public/a"); });
  const Origin inside{"memory://inside/w.wrl", AddressSpace::local};
  CHECK(bench.load(from(kPublic, "memory://public/a")).done);
  const Outcome& refused = bench.load(from(kPublic, "memory://inside/a"));
  REQUIRE(refused.events == "!");
  CHECK(refused.error->kind == LoadErrorKind::forbidden);
  CHECK(
      refused.error->message ==
      "cannot load memory://inside/a: its address is of a local network; a document of the Internet may not reach it");
  CHECK(bench.load(from(kPublic, "memory://public/in")).error->kind == LoadErrorKind::forbidden);
  CHECK(bench.load(from(inside, "memory://inside/a")).done);
  CHECK(bench.load(from(inside, "memory://public/a")).done);
  CHECK(bench.load(from(inside, "memory://inside/out")).done);
  // The user may request any URL, but a public server may not redirect there.
  CHECK(bench.load("memory://inside/a").done);
  CHECK(bench.load("memory://public/in").error->kind == LoadErrorKind::forbidden);
}

TEST_CASE("reports the address space of its host in the head") {
  Bench bench;
  bench.network->put("memory://inside/a", [](const auto&, unsigned) { return answer_of(AddressSpace::local); });
  const Outcome& got = bench.load("memory://inside/a");
  CHECK(got.head.origin() == Origin{"memory://inside/a", AddressSpace::local});
}

TEST_CASE("stops loading when a name later resolves to a more private address") {
  Bench bench;
  const std::string text = pattern(50'000);
  bench.network->put("memory://rebound/a", [&](const TransferRequest& request, unsigned transfer) {
    MemoryResource resource;
    resource.bytes = bytes_of(text);
    resource.validator.etag = "\"1\"";
    MemoryAnswer answer = answer_well(resource, request);
    answer.head.space = transfer == 0 ? AddressSpace::global : AddressSpace::loopback;
    if (transfer == 0) answer.break_after = 20'000;
    return answer;
  });
  const Outcome& got = bench.load("memory://rebound/a");
  REQUIRE(got.error);
  CHECK(got.error->kind == LoadErrorKind::forbidden);
  CHECK(got.received == 20'000);
}

TEST_CASE("stores the origin of its bytes in the cache") {
  const TemporaryFolder folder;
  auto opened = HttpCache::open({folder.path(), std::uint64_t{1} << 20, 16, 0, [] { return 1; }}, 1'700'000'000);
  Bench bench({}, std::move(std::get<std::unique_ptr<HttpCache>>(opened)));
  bench.network->put("memory://inside/a", [](const auto&, unsigned) {
    MemoryAnswer answer = answer_of(AddressSpace::local, "secret");
    answer.head.cache_control.max_age = 3600;
    answer.head.validator.etag = "\"1\"";
    return answer;
  });
  REQUIRE(bench.load("memory://inside/a").text() == "secret");
  const Outcome& again = bench.load("memory://inside/a");
  CHECK(again.head.from_cache);
  CHECK(again.head.space == AddressSpace::local);
  CHECK(bench.network->transfers().size() == 1);
  const Outcome& refused = bench.load(from(kPublic, "memory://inside/a"));
  CHECK(refused.events == "!");
  CHECK(refused.error->kind == LoadErrorKind::forbidden);
}

TEST_CASE("refuses redirects from https to http, and to URLs with a password") {
  const Origin secure{"https://a.example/w.wrl", AddressSpace::global};
  Bench bench;
  CHECK(bench.load(from(secure, "http://b.example/x")).error->message ==
        "cannot load http://b.example/x: a document of https: may not refer to http:, which is not protected against "
        "changes in transit; expected https:");
  CHECK(bench.load(from(kPublic, "http://user:secret@b.example/x")).error->message ==
        "cannot load http://b.example/x: a document may not specify a user or password; expected http://HOST/PATH");
  bench.network->put("memory://a/x", [](const auto&, unsigned) {
    return redirect(AddressSpace::global, "http://user:secret@b.example/x");
  });
  const Outcome& got = bench.load("memory://a/x");
  REQUIRE(got.error);
  CHECK(got.error->kind == LoadErrorKind::forbidden);
  CHECK(got.error->message ==
        "cannot load memory://a/x: the server redirects to http://b.example/x: a document may not specify a user or "
        "password; expected http://HOST/PATH");
}

TEST_CASE("reads files only as the policy allows") {
  const TemporaryFolder folder;
  std::ofstream(folder / "a") << "text";
  const std::string url = url_of_path(folder / "a").text();
  Bench bench;
  CHECK(bench.load(url).text() == "text");
  const Origin world{url_of_path(folder / "w.wrl").text()};
  CHECK(bench.load(from(world, url)).error->kind == LoadErrorKind::forbidden);
  bench.options.policy.allow(folder.path());
  CHECK(bench.load(from(world, url)).text() == "text");
  CHECK(bench.load(from(kPublic, url)).error->kind == LoadErrorKind::forbidden);
}

// Over sockets -----------------------------------------------------------------------------------

/// Treats 127.0.0.1 as a public host. Other addresses keep their address space.
AddressSpace one_is_public(const IpAddress& address) {
  return address == *ip_address_of("127.0.0.1") ? AddressSpace::global : address_space_of(address);
}

LoaderOptions pretending() {
  LoaderOptions options;
  options.proxy_from_environment = false;
  options.space_of = one_is_public;
  options.max_retries = 0;
  return options;
}

void say_hello(Exchange& exchange) {
  exchange.keep_alive = true;
  exchange.send(http("200 OK", "", "hello"));
}

TEST_CASE("opens no connection to an address that a public text may not reach") {
  BadServer outside(say_hello), inside(say_hello, "127.0.0.2");
  const auto loader = Loader::create(pretending());
  CHECK(load(*loader, from(kPublic, outside.url())).text() == "hello");
  const Outcome got = load(*loader, from(kPublic, inside.url()));
  REQUIRE(got.error);
  CHECK(got.error->kind == LoadErrorKind::forbidden);
  CHECK(got.error->message ==
        "cannot load " + inside.url() +
            ": the address 127.0.0.2 is of this machine; a document of the Internet may not reach it");
  CHECK(inside.connections() == 0);
  // The request is refused under any name of the host.
  const std::string port = inside.url("").substr(inside.url("").rfind(':'));
  for (const char* host : {"127.2", "2130706434", "0x7f.0.0.2", "0177.0.0.2", "127.0.0.2.", "[::ffff:127.0.0.2]"}) {
    INFO(host);
    CHECK(load(*loader, from(kPublic, "http://" + std::string(host) + port + "/a")).error);
  }
  CHECK(inside.connections() == 0);
  CHECK(load(*loader, inside.url()).text() == "hello");
}

TEST_CASE("opens a new connection instead of reusing one of another origin") {
  std::atomic<AddressSpace> space = AddressSpace::local;
  LoaderOptions options = pretending();
  options.space_of = [&space](const IpAddress&) { return space.load(); };
  BadServer server(say_hello);
  const auto loader = Loader::create(std::move(options));
  CHECK(load(*loader, server.url()).text() == "hello");
  const Outcome got = load(*loader, from(kPublic, server.url("/b")));
  REQUIRE(got.error);
  CHECK(got.error->kind == LoadErrorKind::forbidden);
  CHECK(server.requests().size() == 1);
  CHECK(server.connections() == 1);
}

TEST_CASE("checks a name at each connection") {
  std::atomic<unsigned> lookups = 0;
  LoaderOptions options = pretending();
  // Simulates a name server that first returns a public address, then a local one.
  options.space_of = [&](const IpAddress&) { return lookups++ < 2 ? AddressSpace::global : AddressSpace::loopback; };
  BadServer server([](Exchange& exchange) { exchange.send(http("200 OK", "Connection: close\r\n", "hello")); });
  const auto loader = Loader::create(std::move(options));
  CHECK(load(*loader, from(kPublic, server.url())).text() == "hello");
  CHECK(load(*loader, from(kPublic, server.url())).error->kind == LoadErrorKind::forbidden);
  CHECK(server.connections() == 1);
}

TEST_CASE("refuses a redirect of a public server to this machine") {
  BadServer inside(say_hello, "127.0.0.2");
  BadServer outside(
      [&](Exchange& exchange) { exchange.send(http("302 Found", "Location: " + inside.url() + "\r\n", "")); });
  const auto loader = Loader::create(pretending());
  for (const Origin& origin : {kPublic, Origin{}}) {
    const Outcome got = load(*loader, from(origin, outside.url()));
    REQUIRE(got.error);
    CHECK(got.error->kind == LoadErrorKind::forbidden);
  }
  CHECK(inside.connections() == 0);
  CHECK(outside.connections() > 0);
}

TEST_CASE("opens no connection for a URL without a host, also after a redirect") {
  BadServer inside(say_hello);
  const std::string place = inside.url("").substr(7);
  const std::vector<std::string> bad{
      "http:///user:pw@" + place + "/x", "http:/" + place + "/x",  "http:" + place + "/x",
      "http:////" + place + "/x",        "ftp:///" + place + "/x", "http://@/" + place};
  const auto loader = Loader::create(pretending());
  for (const std::string& url : bad)
    for (const Origin& origin : {kPublic, Origin{"file:///w/w.wrl"}, Origin{}}) {
      INFO(url);
      const Outcome got = load(*loader, from(origin, url));
      REQUIRE(got.error);
      CHECK(got.error->kind == LoadErrorKind::forbidden);
      CHECK(got.error->message.find("it has no host or an invalid port; expected ") != std::string::npos);
      CHECK(got.error->message.find("pw") == std::string::npos);
    }
  std::string target;
  BadServer outside([&](Exchange& exchange) {
    exchange.send(http("302 Found", "Location: " + target + "\r\nConnection: close\r\n", ""));
  });
  for (const std::string& url : bad) {
    INFO(url);
    target = url;
    const Outcome got = load(*loader, outside.url());
    REQUIRE(got.error);
    CHECK(got.error->kind == LoadErrorKind::forbidden);
    CHECK(got.error->message.find("pw") == std::string::npos);
  }
  target = "///" + place + "/x";
  CHECK(load(*loader, outside.url()).error->kind == LoadErrorKind::forbidden);
  CHECK(inside.connections() == 0);
}

TEST_CASE("loads and reports a URL in its canonical spelling") {
  BadServer server(say_hello);
  const auto loader = Loader::create(pretending());
  const Outcome got = load(*loader, "HTTP" + server.url("/a#b").substr(4));
  CHECK(got.text() == "hello");
  CHECK(got.head.url == server.url("/a"));
  BadServer outside([&](Exchange& exchange) {
    exchange.send(http("302 Found", "Location: HTTP" + server.url("/c#d").substr(4) + "\r\n", ""));
  });
  CHECK(load(*loader, outside.url()).head.url == server.url("/c"));
}

TEST_CASE("judges hosts by their names behind a proxy") {
  BadServer proxy(say_hello, "127.0.0.2");
  ::setenv("http_proxy", proxy.url("").c_str(), 1);
  ::setenv("no_proxy", "direct.invalid", 1);
  LoaderOptions options = pretending();
  options.proxy_from_environment = true;
  const auto loader = Loader::create(std::move(options));
  const auto of = [&](const std::string& url) { return load(*loader, from(kPublic, url)); };
  const Outcome good = of("http://public.example/a");
  CHECK(good.text() == "hello");
  CHECK(good.head.space == AddressSpace::global);
  for (const char* url : {"http://localhost/a", "http://x.LOCALHOST./a", "http://127.0.0.3/a", "http://2130706435/a",
                          "http://10.0.0.1/a", "http://[::1]/a"}) {
    INFO(url);
    const Outcome bad = of(url);
    REQUIRE(bad.error);
    CHECK(bad.error->kind == LoadErrorKind::forbidden);
  }
  CHECK(proxy.requests().size() == 1);
  CHECK(of("http://direct.invalid/a").error->kind == LoadErrorKind::unreachable);
  ::unsetenv("http_proxy");
  ::unsetenv("no_proxy");
}

}  // namespace
