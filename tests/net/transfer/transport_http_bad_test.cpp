#include <catch2/catch.hpp>

#include "tests/gzip.h"
#include "tests/net/bad_server.h"
#include "tests/net/load_helpers.h"

/// The loader with servers that misbehave: each case gives a clear message and a defined order of events.
namespace {

using namespace gs::net;
using namespace gs::net::test;
using Exchange = BadServer::Exchange;

LoaderOptions impatient() {
  LoaderOptions options;
  options.proxy_from_environment = false;
  options.connect_timeout = Milliseconds(2000);
  options.head_timeout = Milliseconds(150);
  options.stall_timeout = Milliseconds(100);
  options.retry_delay = Milliseconds(4);
  options.max_retry_after = Milliseconds(2000);
  return options;
}

/// Returns the bytes that a Range header requests.
std::string part_of(const std::string& text, const Exchange& exchange, const std::string& etag) {
  const std::string range = exchange.header("Range");
  if (range.empty()) return http("200 OK", "Accept-Ranges: bytes\r\nETag: " + etag + "\r\n", text);
  const std::size_t dash = range.find('-'), begin = std::stoul(range.substr(6));
  const std::size_t last = dash + 1 < range.size() ? std::stoul(range.substr(dash + 1)) : text.size() - 1;
  return http("206 Partial Content",
              "ETag: " + etag + "\r\nContent-Range: bytes " + std::to_string(begin) + "-" + std::to_string(last) + "/" +
                  std::to_string(text.size()) + "\r\n",
              text.substr(begin, last + 1 - begin));
}

struct Result {
  Outcome got;
  std::string message;  // after the URL
  std::vector<std::string> requests;
  LoadErrorKind kind() const { return got.error ? got.error->kind : LoadErrorKind::bad_request; }
};

Result load_from(const BadServer::Handler& handler, Request request = {}, LoaderOptions options = impatient()) {
  BadServer server(handler);
  const auto loader = Loader::create(std::move(options));
  request.url = server.url();
  Result result;
  result.got = load(*loader, std::move(request));
  if (result.got.error) {
    const std::string start = "cannot load " + server.url() + ": ";
    result.message = result.got.error->message;
    if (result.message.starts_with(start)) result.message.erase(0, start.size());
  }
  result.requests = server.requests();
  return result;
}

TEST_CASE("resumes after a broken connection, with the same version only") {
  const std::string text = pattern(200'000);
  const auto killed_once = [&](const std::string& second_etag, const std::string& second_text) {
    return load_from([&, second_etag, second_text](Exchange& exchange) {
      if (exchange.number == 0) {
        exchange.send("HTTP/1.1 200 OK\r\nETag: \"1\"\r\nContent-Length: 200000\r\n\r\n" + text.substr(0, 90'000));
        exchange.sleep(std::chrono::milliseconds(20));
        return;
      }
      exchange.send(exchange.header("If-Range") == second_etag
                        ? part_of(second_text, exchange, second_etag)
                        : http("200 OK", "ETag: " + second_etag + "\r\n", second_text));
    });
  };
  SECTION("the same") {
    const Result result = killed_once("\"1\"", text);
    CHECK(result.got.events == "Hd.");
    CHECK((result.got.text() == text));
    REQUIRE(result.requests.size() == 2);
    CHECK(result.requests[1].find("\r\nRange: bytes=90000-\r\n") != std::string::npos);
    CHECK(result.requests[1].find("\r\nIf-Range: \"1\"\r\n") != std::string::npos);
  }
  SECTION("another") {
    const std::string other = pattern(100'000, 1);
    const Result result = killed_once("\"2\"", other);
    CHECK(result.got.events == "HdRHd.");
    CHECK((result.got.text() == other));
  }
}

TEST_CASE("gives up after four connections that break at once") {
  const Result result = load_from([](Exchange& exchange) { exchange.reset(); });
  CHECK(result.got.events == "!");
  CHECK(result.kind() == LoadErrorKind::broken);
  CHECK(result.requests.size() >= 4);
  CHECK(result.message.find("(after 4 attempts)") != std::string::npos);
}

TEST_CASE("reports that no server answers") {
  std::string url;
  {
    const BadServer server([](Exchange&) {});
    url = server.url();
  }
  const auto loader = Loader::create(impatient());
  const Outcome got = load(*loader, url);
  CHECK(got.events == "!");
  CHECK(got.error->kind == LoadErrorKind::unreachable);
  CHECK(got.error->message.starts_with("cannot load " + url + ": the server cannot be reached ("));
}

TEST_CASE("gives up servers that stall before, within or after the head") {
  const Result silent = load_from([](Exchange& exchange) { exchange.sleep(); });
  CHECK(silent.got.events == "!");
  CHECK(silent.kind() == LoadErrorKind::timed_out);
  CHECK(silent.message == "no complete header was received within 150 ms (after 4 attempts)");

  const Result slow_loris = load_from([](Exchange& exchange) {
    exchange.send("HTTP/1.1 200 OK\r\n");
    for (int i = 0; i < 200 && exchange.send("X-" + std::to_string(i) + ": y\r\n"); ++i)
      exchange.sleep(std::chrono::milliseconds(20));
  });
  CHECK(slow_loris.message == "no complete header was received within 150 ms (after 4 attempts)");

  const Result body = load_from([](Exchange& exchange) {
    exchange.send("HTTP/1.1 200 OK\r\nETag: \"1\"\r\nContent-Length: 1000\r\n\r\nabc");
    exchange.sleep();
  });
  CHECK(body.got.events.starts_with("Hd"));
  CHECK(body.got.events.back() == '!');
  CHECK(body.kind() == LoadErrorKind::timed_out);
  CHECK(body.message.starts_with("no byte of the body was received within 100 ms"));
}

TEST_CASE("detects fewer bytes than announced") {
  const std::string text = pattern(1000);
  const Result result =
      load_from([&](Exchange& exchange) { exchange.send("HTTP/1.1 200 OK\r\nContent-Length: 5000\r\n\r\n" + text); });
  CHECK(result.got.events.back() == '!');
  CHECK(result.kind() == LoadErrorKind::broken);
  CHECK(result.message ==
        "the connection was interrupted (transfer closed with 4000 bytes remaining to read), and the server gives no "
        "validator "
        "for its version; no version was received completely (tried 4 times)");
  const Result chunked = load_from([](Exchange& exchange) {
    exchange.send("HTTP/1.1 200 OK\r\nETag: \"1\"\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\nff\r\nabc");
  });
  CHECK(chunked.kind() == LoadErrorKind::broken);
}

TEST_CASE("rejects a Content-Length that is too small, repeated or no number") {
  const Result small =
      load_from([](Exchange& exchange) { exchange.send("HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\nabcdefgh"); });
  CHECK(small.got.events == "Hd.");
  CHECK(small.got.text() == "abc");
  for (const char* length : {"-5", "x", "99999999999999999999999"}) {
    const Result odd = load_from([length](Exchange& exchange) {
      exchange.send(std::string("HTTP/1.1 200 OK\r\nContent-Length: ") + length + "\r\n\r\nabc");
    });
    CHECK(odd.got.ended());
    CHECK(odd.got.received <= 3);
  }
  Request request;
  request.max_bytes = 1'000'000;
  const Result huge = load_from(
      [](Exchange& exchange) { exchange.send("HTTP/1.1 200 OK\r\nContent-Length: 9000000000000000000\r\n\r\nabc"); },
      request);
  CHECK(huge.kind() == LoadErrorKind::too_large);
  CHECK(huge.message == "it has 9000000000000000000 bytes; expected at most 1000000");
}

TEST_CASE("rejects garbage instead of HTTP") {
  for (const std::string& text : {std::string("\0\1\2\3 garbage \xff\xfe", 16), std::string("SSH-2.0-OpenSSH_9\r\n"),
                                  std::string("HTTP/9.9 abc\r\n\r\n"), std::string("\r\n\r\n\r\n")}) {
    const Result result = load_from([&text](Exchange& exchange) { exchange.send(text); });
    CHECK(result.got.events == "!");
    CHECK(result.kind() == LoadErrorKind::bad_response);
    CHECK(result.message.starts_with("the server does not speak HTTP"));
  }
  const Result chunks = load_from(
      [](Exchange& exchange) { exchange.send("HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nnonsense\r\n"); });
  CHECK(chunks.got.events.back() == '!');
}

TEST_CASE("rejects headers without end") {
  const Result result = load_from([](Exchange& exchange) {
    exchange.send("HTTP/1.1 200 OK\r\n");
    const std::string line = "X: " + std::string(1000, 'x') + "\r\n";
    while (exchange.send(line)) {
    }
  });
  CHECK(result.got.events == "!");
  CHECK(result.kind() == LoadErrorKind::bad_response);
  CHECK(result.message == "the server sent more than 65536 bytes of headers");
}

TEST_CASE("rejects endless redirects, redirects to files and to nonsense") {
  const Result loop = load_from([](Exchange& exchange) {
    exchange.keep_alive = exchange.send(http("302 Found", "Location: /a\r\n", "over there"));
  });
  CHECK(loop.got.events == "!");
  CHECK(loop.kind() == LoadErrorKind::too_many_redirects);
  CHECK(loop.message.ends_with("too many redirects; expected at most 10 redirects"));
  CHECK(loop.requests.size() == 11);
  for (const char* target : {"file:///etc/passwd", "gopher://x/", "data:,x", "ftp://127.0.0.1/"}) {
    const Result file = load_from([target](Exchange& exchange) {
      exchange.send(http("301 Moved", std::string("Location: ") + target + "\r\n", ""));
    });
    CHECK(file.got.events == "!");
    CHECK(file.kind() == LoadErrorKind::forbidden);
    CHECK(file.message == std::string("the server redirects to ") + target + "; expected http or https");
  }
}

TEST_CASE("keeps the connection across a redirect, and ignores its body") {
  const Result result = load_from([](Exchange& exchange) {
    const bool first = exchange.request.starts_with("GET /a ");
    exchange.keep_alive = exchange.send(first ? http("302 Found", "Location: b?c#d\r\n", std::string(1000, 'x'))
                                              : http("200 OK", "", "arrived"));
  });
  CHECK(result.got.text() == "arrived");
  CHECK(result.got.head.url.ends_with("/b?c"));
  const Result endless = load_from([](Exchange& exchange) {
    if (!exchange.request.starts_with("GET /a ")) {
      exchange.send(http("200 OK", "", "arrived"));
      return;
    }
    exchange.send("HTTP/1.1 302 Found\r\nLocation: b\r\nTransfer-Encoding: chunked\r\n\r\n");
    while (exchange.send("400\r\n" + std::string(1024, 'x') + "\r\n")) {
    }
  });
  CHECK(endless.got.text() == "arrived");
}

TEST_CASE("takes the requested ranges from a 200 answer") {
  const std::string text = pattern(1'000'000);
  Request request;
  request.ranges = {{500'000, 500'100}, {10, 20}};
  const Result result = load_from([&](Exchange& exchange) { exchange.send(http("200 OK", "", text)); }, request);
  CHECK(result.got.events == "Hd.");
  CHECK(result.got.in_order);
  CHECK((result.got.pieces.at(500'000) == text.substr(500'000, 100)));
  CHECK(result.requests.size() == 1);
}

TEST_CASE("rejects an ETag that changes with each answer") {
  const std::string text = pattern(100'000);
  Request request;
  request.ranges = {{0, 100}, {50'000, 50'100}};
  const Result result = load_from(
      [&](Exchange& exchange) { exchange.send(part_of(text, exchange, '"' + std::to_string(exchange.number) + '"')); },
      request);
  CHECK(result.got.events.back() == '!');
  CHECK(result.kind() == LoadErrorKind::changed);
  CHECK(result.message ==
        "it changed on the server during the transfer; no version was received completely (tried 4 times)");
}

TEST_CASE("stops a compressed body that never ends") {
  std::string bomb = gs::test::deflated(std::string(16 << 20, '\0'));
  const auto serve = [&bomb](Exchange& exchange) { exchange.send(http("200 OK", "Content-Encoding: gzip\r\n", bomb)); };
  Request request;
  request.max_bytes = 1'000'000;
  const Result result = load_from(serve, request);
  CHECK(result.got.events.back() == '!');
  CHECK(result.kind() == LoadErrorKind::too_large);
  CHECK(result.message == "more than 1000000 bytes were received after decompression, the limit of this request");
  request.max_bytes = 16 << 20;
  CHECK(load_from(serve, request).got.received == 16 << 20);
  bomb[bomb.size() / 2] ^= 0x55;
  const Result damaged = load_from(serve, request);
  CHECK(damaged.got.events.back() == '!');
}

TEST_CASE("reports error answers") {
  for (const auto& [status, kind] : std::vector<std::pair<std::string, LoadErrorKind>>{
           {"404 Not Found", LoadErrorKind::not_found}, {"403 Forbidden", LoadErrorKind::http_status}}) {
    const Result result =
        load_from([&status](Exchange& exchange) { exchange.send(http(status, "", "<html>sorry</html>")); });
    CHECK(result.got.events == "!");
    CHECK(result.kind() == kind);
    CHECK(result.message == "the server answered " + status + "; expected 200 OK");
    CHECK(result.requests.size() == 1);
  }
  const Result broken = load_from([](Exchange& exchange) { exchange.send(http("500 Oops", "", "")); });
  CHECK(broken.got.error->http_status == 500);
  CHECK(broken.requests.size() == 4);
  CHECK(broken.message == "the server answered 500 Internal Server Error; expected 200 OK (after 4 attempts)");
  const Result busy = load_from([](Exchange& exchange) {
    exchange.send(exchange.number == 0 ? http("503 Busy", "Retry-After: 1\r\n", "") : http("200 OK", "", "abc"));
  });
  CHECK(busy.got.text() == "abc");
  CHECK(busy.requests.size() == 2);
  const Result away =
      load_from([](Exchange& exchange) { exchange.send(http("503 Away", "Retry-After: 9999\r\n", "")); });
  CHECK(away.message == "the server answered 503 Service Unavailable; expected 200 OK; retry in 9999 s");
}

TEST_CASE("sends passwords to the server and shows them in no message") {
  BadServer server([](Exchange& exchange) { exchange.send(http("403 No", "", "")); });
  const auto loader = Loader::create(impatient());
  std::string url = server.url();
  url.insert(7, "user:secret@");
  const Outcome got = load(*loader, url);
  CHECK(got.error->message.find("secret") == std::string::npos);
  CHECK(server.requests().at(0).find("Authorization: Basic dXNlcjpzZWNyZXQ=") != std::string::npos);
}

TEST_CASE("closes the loader at once although servers stall") {
  BadServer server([](Exchange& exchange) {
    exchange.send("HTTP/1.1 200 OK\r\nContent-Length: 1000\r\n\r\nabc");
    exchange.sleep();
  });
  LoaderOptions patient = impatient();
  patient.stall_timeout = patient.head_timeout = Milliseconds(3'600'000);
  auto loader = Loader::create(patient);
  std::vector<RequestId> ids;
  for (int i = 0; i < 20; ++i) {
    Request request;
    request.url = server.url("/" + std::to_string(i));
    ids.push_back(loader->request(request));
  }
  // Waits until something is received, so that transfers run.
  while (loader->queued_bytes() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  loader->cancel(ids[0]);
  loader.reset();  // would hang if it waited for the server
  SUCCEED();
}

TEST_CASE("stops reading from a server while the owner does not poll") {
  std::atomic<std::uint64_t> sent{0};
  const std::string block = pattern(65536);
  BadServer server([&](Exchange& exchange) {
    exchange.send("HTTP/1.1 200 OK\r\nContent-Length: 33554432\r\n\r\n");
    for (int i = 0; i < 512 && exchange.send(block); ++i) sent += block.size();
  });
  LoaderOptions options = impatient();
  options.max_queued_bytes = options.max_queued_bytes_per_request = 256 << 10;
  const auto loader = Loader::create(options);
  Request request;
  request.url = server.url();
  const RequestId id = loader->request(request);
  while (loader->queued_bytes() < (256 << 10)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  // This is longer than the stall time-out, which must not run meanwhile.
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  CHECK(loader->queued_bytes() <= (256 << 10) + 16384);
  CHECK(sent < 32 << 20);
  const Outcome got = wait_for(*loader, {id}, 1 << 20)[id];
  CHECK(got.events == "Hd.");
  CHECK(got.received == 32 << 20);
}

}  // namespace
