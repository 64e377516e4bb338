#include "net/load/load_engine.h"

#include <catch2/catch.hpp>

#include "tests/net/load_helpers.h"

namespace {

using namespace gs::net;
using namespace gs::net::test;

/// Scripts the answers of a URL in sequence. The last answer repeats.
void script(Bench& bench, const std::string& url,
            std::vector<std::function<MemoryAnswer(const TransferRequest&)>> answers) {
  bench.network->put(url, [answers](const TransferRequest& request, unsigned transfer) {
    return answers[std::min<std::size_t>(transfer, answers.size() - 1)](request);
  });
}

TEST_CASE("delivers head, data and end of a whole resource") {
  Bench bench;
  const std::string text = pattern(100'000);
  bench.network->put("memory:a", resource(text));
  const Outcome& got = bench.load("MEMORY:a#fragment");
  CHECK(got.events == "Hd.");
  CHECK(got.text() == text);
  CHECK(got.in_order);
  CHECK(got.head.url == "memory:a");
  CHECK(got.head.total == text.size());
  CHECK(got.head.content_type == "model/vrml");
  CHECK(got.head.validator.etag == "\"1\"");
  CHECK(got.head.accepts_ranges);
  CHECK_FALSE(got.head.from_cache);
  CHECK_FALSE(bench.network->transfers().at(0).range);
}

TEST_CASE("ends an empty resource at once") {
  Bench bench;
  bench.network->put("memory:a", resource(""));
  CHECK(bench.load("memory:a").events == "H.");
  CHECK(bench.load(ranges_of("memory:a", {{0, 100}})).events == "H.");
}

TEST_CASE("joins nearby ranges to one request, and delivers only the requested bytes") {
  Bench bench;
  const std::string text = pattern(200'000);
  bench.network->put("memory:a", resource(text));
  const Outcome& got =
      bench.load(ranges_of("memory:a", {{0, 100}, {50'000, 60'000}, {1000, 2000}, {199'000, 300'000}}));
  CHECK(got.events == "Hd.");
  CHECK(got.pieces == std::map<std::uint64_t, std::string>{{0, text.substr(0, 100)},
                                                           {1000, text.substr(1000, 1000)},
                                                           {50'000, text.substr(50'000, 10'000)},
                                                           {199'000, text.substr(199'000)}});
  const auto transfers = bench.network->transfers();
  REQUIRE(transfers.size() == 3);
  CHECK(transfers[0].range == ByteRange{0, 2000});
  CHECK(transfers[1].range == ByteRange{50'000, 60'000});
  CHECK(transfers[1].if_range == "\"1\"");
}

TEST_CASE("waits for the first answer, and runs later requests of the resource in parallel") {
  Bench bench;
  const std::string text = pattern(100'000);
  bench.network->put("memory:a", [&](const TransferRequest& request, unsigned) {
    MemoryAnswer answer = answer_well(resource(text), request);
    answer.latency = Milliseconds(100);
    return answer;
  });
  bench.load(ranges_of("memory:a", {{0, 10}, {20'000, 20'010}, {40'000, 40'010}}));
  CHECK(bench.now == TimePoint{} + Milliseconds(200));
  bench.load(ranges_of("memory:a", {{1000, 1010}, {21'000, 21'010}, {41'000, 41'010}}));
  CHECK(bench.now == TimePoint{} + Milliseconds(300));
}

TEST_CASE("reads a server without ranges from the front, only as far as needed") {
  Bench bench;
  const std::string text = pattern(1'000'000);
  MemoryResource what = resource(text);
  what.ranges = false;
  bench.network->put("memory:a", what);
  const Outcome& got = bench.load(ranges_of("memory:a", {{60'000, 60'010}, {10, 20}, {100'000, 100'010}}));
  CHECK(got.events == "Hd.");
  CHECK(got.in_order);
  CHECK_FALSE(got.head.accepts_ranges);
  CHECK(got.pieces.size() == 3);
  CHECK(got.pieces.at(60'000) == text.substr(60'000, 10));
  CHECK(bench.network->transfers().size() == 1);
}

TEST_CASE("reports a range after the end as an error, and cuts a range across it") {
  Bench bench;
  bench.network->put("memory:a", resource(pattern(1000)));
  CHECK(bench.load(ranges_of("memory:a", {{990, 2000}})).received == 10);
  const Outcome& behind = bench.load(ranges_of("memory:a", {{1000, 1001}}));
  CHECK(behind.error->kind == LoadErrorKind::bad_request);
  CHECK(behind.error->message == "cannot load memory:a: byte 1000 was requested; it has 1000 bytes");
  CHECK(bench.load(ranges_of("memory:a", {{0, 10}, {6000, 6001}})).error->kind == LoadErrorKind::bad_request);
}

TEST_CASE("waits for a server that has answered and restarts, but not for an unknown one") {
  const auto refused = [](const TransferRequest&) {
    MemoryAnswer answer;
    answer.refused = LoadError{LoadErrorKind::unreachable, "the server cannot be reached"};
    return answer;
  };
  const std::string text = pattern(1000);
  const auto answers = [&](const TransferRequest& request) { return answer_well(resource(text), request); };
  Bench bench;
  script(bench, "memory:a", {refused, answers});
  CHECK(bench.load("memory:a").error->message == "cannot load memory:a: the server cannot be reached");
  CHECK(bench.load("memory:a").events == "Hd.");
  script(bench, "memory:b", {refused, refused, refused, refused, refused, refused, answers});
  const TimePoint before = bench.now;
  CHECK(bench.load("memory:b").text() == text);
  CHECK(bench.now - before > std::chrono::seconds(7));
  script(bench, "memory:c", {refused});
  const Outcome& never = bench.load("memory:c");
  CHECK(never.error->message == "cannot load memory:c: the server cannot be reached (after 7 attempts)");
}

TEST_CASE("rejects invalid requests") {
  Bench bench;
  const auto message = [&](Request request) {
    const Outcome& got = bench.load(request);
    REQUIRE(got.events == "!");
    return got.error->message;
  };
  Request request;
  CHECK(message(request) == "cannot load : it is empty; expected an absolute URL");
  request.url = "http://a b/";
  CHECK(message(request) ==
        "cannot load http://a b/: it contains a blank or a control character; expected percent-encoding");
  request.url = "gopher://a/";
  CHECK(message(request).find("the scheme gopher: is not known") != std::string::npos);
  request.url = "file:///etc/passwd";
  request.from = {"http://a/b.wrl"};
  CHECK(message(request) ==
        "cannot load file:///etc/passwd: a document of http: may not refer to file:; expected one of "
        "data, http, https, ftp, cells");
  request.url = "cells://a/b";
  CHECK(message(request) == "cannot load cells://a/b: no transport for the scheme cells:");
  bench.engine->refuse_transport(TransportKind::http, "libx.so cannot be opened");
  request.url = "https://a/b";
  CHECK(message(request) == "cannot load https://a/b: no transport for the scheme https: (libx.so cannot be opened)");
  request.url = "memory:a";
  CHECK(message(request) == "cannot load memory:a: the server answered 404 Not Found; expected 200 OK");
  CHECK(message(ranges_of("memory:a", {{5, 5}})) == "cannot load memory:a: an empty range was requested (5 to 5)");
  CHECK(message(ranges_of("memory:a", std::vector<ByteRange>(5000))).find("at most 4096") != std::string::npos);
  request.accept = "a\r\nX: y";
  CHECK(message(request).find("control character") != std::string::npos);
  CHECK(bench.network->transfers().size() == 1);
}

TEST_CASE("resumes a broken transfer at its break if the version is certain") {
  Bench bench;
  const std::string text = pattern(100'000);
  const auto breaks = [&](const TransferRequest& request) {
    MemoryAnswer answer = answer_well(resource(text), request);
    answer.break_after = 40'000;
    return answer;
  };
  const auto works = [&](const TransferRequest& request) { return answer_well(resource(text), request); };
  SECTION("by ETag") {
    script(bench, "memory:a", {breaks, breaks, works});
    const Outcome& got = bench.load("memory:a");
    CHECK(got.events == "Hd.");
    CHECK(got.text() == text);
    CHECK(got.in_order);
    const auto transfers = bench.network->transfers();
    REQUIRE(transfers.size() == 3);
    CHECK(transfers[1].range->begin == 40'000);
    CHECK(transfers[1].if_range == "\"1\"");
    CHECK(transfers[2].range->begin == 80'000);
  }
  SECTION("of a range") {
    script(bench, "memory:a", {breaks, works});
    const Outcome& got = bench.load(ranges_of("memory:a", {{1000, 90'000}}));
    CHECK(got.pieces.at(1000) == text.substr(1000, 89'000));
    CHECK(bench.network->transfers().at(1).range == ByteRange{41'000, 90'000});
  }
  SECTION("a server without ranges starts over, and what is known is passed over") {
    const auto no_ranges = [&](const TransferRequest& request) {
      MemoryResource what = resource(text);
      what.ranges = false;
      return answer_well(what, request);
    };
    script(bench, "memory:a", {breaks, no_ranges});
    const Outcome& got = bench.load("memory:a");
    CHECK(got.events == "Hd.");
    CHECK(got.text() == text);
  }
  SECTION("without ETag it starts again, and says so") {
    const auto nameless = [&](std::optional<std::uint64_t> breaks_after) {
      return [&text, breaks_after](const TransferRequest& request) {
        MemoryAnswer answer = answer_well(resource(text, ""), request);
        answer.break_after = breaks_after;
        answer.bytes_per_second = 1'000'000;
        return answer;
      };
    };
    script(bench, "memory:a", {nameless(40'000), nameless(std::nullopt)});
    const Outcome& got = bench.load("memory:a");
    CHECK(got.events == "HdRHd.");
    CHECK(got.text() == text);
  }
}

TEST_CASE("retries with growing delays, and then gives up") {
  Bench bench;
  std::vector<TimePoint> times;
  bench.network->put("memory:a", [&](const TransferRequest&, unsigned) {
    times.push_back(bench.now);
    MemoryAnswer answer;
    answer.head.status = 503;
    return answer;
  });
  const Outcome& got = bench.load("memory:a");
  CHECK(got.error->http_status == 503);
  CHECK(got.error->message ==
        "cannot load memory:a: the server answered 503 Service Unavailable; expected 200 OK (after 4 attempts)");
  REQUIRE(times.size() == 4);
  for (std::size_t i = 1; i < times.size(); ++i) {
    const auto delay = times[i] - times[i - 1];
    CHECK(delay <= Milliseconds(250) * (1 << (i - 1)));
    CHECK(delay >= Milliseconds(125) * (1 << (i - 1)));
  }
}

TEST_CASE("obeys Retry-After if it is not too long") {
  Bench bench;
  const auto busy = [](std::int64_t seconds) {
    return [seconds](const TransferRequest&) {
      MemoryAnswer answer;
      answer.head.status = 503;
      answer.head.retry_after = seconds;
      return answer;
    };
  };
  script(bench, "memory:a", {busy(7), [](const TransferRequest& r) { return answer_well(resource("abc"), r); }});
  CHECK(bench.load("memory:a").text() == "abc");
  CHECK(bench.now >= TimePoint{} + std::chrono::seconds(7));
  script(bench, "memory:b", {busy(3600)});
  CHECK(bench.load("memory:b").error->message ==
        "cannot load memory:b: the server answered 503 Service Unavailable; expected 200 OK; retry in 3600 s");
}

TEST_CASE("does not retry permanent errors") {
  for (const int status : {400, 401, 403, 404, 410, 501, 204, 302}) {
    Bench bench;
    script(bench, "memory:a", {[status](const TransferRequest&) {
             MemoryAnswer answer;
             answer.head.status = status;
             return answer;
           }});
    const Outcome& got = bench.load("memory:a");
    CHECK(got.events == "!");
    CHECK(bench.network->transfers().size() == 1);
    CHECK(got.error->http_status == status);
    CHECK((got.error->kind == LoadErrorKind::not_found) == (status == 404 || status == 410));
  }
}

TEST_CASE("gives up a stalled server and requests again") {
  Bench bench;
  const std::string text = pattern(50'000);
  const auto stalls = [&](const TransferRequest& request) {
    MemoryAnswer answer = answer_well(resource(text), request);
    answer.stall_after = 20'000;
    answer.stall_timeout = Milliseconds(500);
    return answer;
  };
  script(bench, "memory:a", {stalls, stalls, stalls});
  CHECK(bench.load("memory:a").text() == text);
  script(bench, "memory:b", {[](const TransferRequest&) {
           MemoryAnswer answer;
           answer.answers = false;
           return answer;
         }});
  CHECK(bench.load("memory:b").error->kind == LoadErrorKind::timed_out);
}

TEST_CASE("never mixes versions of a resource that changes during reading") {
  Bench bench;
  const std::string old_text = pattern(100'000, 0), new_text = pattern(90'000, 1);
  const auto old_breaks = [&](const TransferRequest& request) {
    MemoryAnswer answer = answer_well(resource(old_text), request);
    answer.break_after = 40'000;
    return answer;
  };
  const auto now_new = [&](const TransferRequest& request) {
    return answer_well(resource(new_text, "\"2\""), request);
  };
  const auto ignores_if_range = [&](const TransferRequest& request) {
    TransferRequest without = request;
    without.if_range.clear();
    return answer_well(resource(new_text, "\"2\""), without);
  };
  SECTION("If-Range: the whole comes") {
    script(bench, "memory:a", {old_breaks, now_new});
    const Outcome& got = bench.load("memory:a");
    CHECK(got.events == "HdRHd.");
    CHECK(got.text() == new_text);
    CHECK(got.head.validator.etag == "\"2\"");
  }
  SECTION("a server that sends a part of the new one all the same") {
    script(bench, "memory:a", {old_breaks, ignores_if_range, now_new});
    const Outcome& got = bench.load("memory:a");
    CHECK(got.events == "HdRHd.");
    CHECK(got.text() == new_text);
  }
  SECTION("ranges too") {
    script(bench, "memory:a", {[&](const TransferRequest& r) { return answer_well(resource(old_text), r); }, now_new});
    const Outcome& got = bench.load(ranges_of("memory:a", {{0, 100}, {50'000, 50'100}}));
    CHECK(got.events == "HdRHd.");
    CHECK(got.pieces.at(0) == new_text.substr(0, 100));
    CHECK(got.pieces.at(50'000) == new_text.substr(50'000, 100));
  }
  SECTION("a change of length is a change") {
    const auto nameless = [](const std::string& text) {
      return [text](const TransferRequest& request) { return answer_well(resource(text, ""), request); };
    };
    script(bench, "memory:a", {nameless(old_text), nameless(new_text)});
    CHECK(bench.load(ranges_of("memory:a", {{0, 100}, {50'000, 50'100}})).events == "HdRHd.");
  }
  SECTION("one that changes each time fails in the end") {
    bench.network->put("memory:a", [&](const TransferRequest& request, unsigned transfer) {
      MemoryAnswer answer = answer_well(resource(old_text, std::to_string(transfer)), request);
      answer.break_after = 40'000;
      return answer;
    });
    const Outcome& got = bench.load("memory:a");
    CHECK(got.events == "HdRHdRHdRHd!");
    CHECK(got.error->kind == LoadErrorKind::changed);
    CHECK(got.error->message ==
          "cannot load memory:a: it changed on the server during the transfer; no version was received completely "
          "(tried 4 times)");
  }
  SECTION("the owner names the version he has the directory of") {
    bench.network->put("memory:a", resource(new_text, "\"2\""));
    Request request = ranges_of("memory:a", {{0, 100}});
    request.validator.etag = "\"1\"";
    const Outcome& got = bench.load(request);
    CHECK(got.events == "!");
    CHECK(got.error->kind == LoadErrorKind::changed);
    CHECK(got.error->message == "cannot load memory:a: it is no longer the requested version");
  }
}

TEST_CASE("drops data that were not polled when the version changes") {
  Bench bench;
  const std::string text = pattern(100'000);
  script(bench, "memory:a",
         {[&](const TransferRequest& request) {
            MemoryAnswer answer = answer_well(resource(text), request);
            answer.break_after = 40'000;
            return answer;
          },
          [&](const TransferRequest& r) { return answer_well(resource(text, "\"2\""), r); }});
  const RequestId id = bench.request("memory:a");
  bench.run(std::chrono::hours(1), false);
  bench.poll();
  CHECK(bench.outcomes[id].events == "Hd.");
  CHECK(bench.outcomes[id].text() == text);
}

TEST_CASE("follows, checks and counts redirects") {
  Bench bench;
  const auto to = [&](const std::string& url, const std::string& location, int status = 302) {
    script(bench, url, {[location, status](const TransferRequest&) {
             MemoryAnswer answer;
             answer.head.status = status;
             answer.head.location = location;
             return answer;
           }});
  };
  to("memory:/a/b", "../c", 301);
  to("memory:/c", "memory:/d#x", 307);
  bench.network->put("memory:/d", resource("abc"));
  const Outcome& got = bench.load("memory:/a/b");
  CHECK(got.text() == "abc");
  CHECK(got.head.url == "memory:/d");
  to("memory:loop", "memory:loop");
  const Outcome& loop = bench.load("memory:loop");
  CHECK(loop.error->kind == LoadErrorKind::too_many_redirects);
  CHECK(loop.error->message ==
        "cannot load memory:loop (redirected from memory:loop): too many redirects; expected at most 10 redirects");
  for (const char* target : {"file:///etc/passwd", "data:,x", "ftp://a/", "cells://a/"}) {
    to("memory:evil", target);
    const Outcome& evil = bench.load("memory:evil");
    CHECK(evil.error->kind == LoadErrorKind::forbidden);
    CHECK(evil.error->message ==
          std::string("cannot load memory:evil: the server redirects to ") + target + "; expected http or https");
  }
  Request secret, post;
  secret.url = post.url = "memory:/c";
  secret.authorization = "Bearer abc";
  post.post = true;
  for (const Request& request : {secret, post}) {
    const Outcome& refused = bench.load(request);
    REQUIRE(refused.error);
    CHECK(refused.error->message == "cannot load memory:/c: the server redirects the request; expected an answer");
  }
  to("memory:long", std::string(10'000, 'x'));
  CHECK(bench.load("memory:long").error->kind == LoadErrorKind::bad_response);
}

TEST_CASE("rejects more bytes than allowed, announced or not") {
  Bench bench;
  Request request;
  request.url = "memory:a";
  request.max_bytes = 1000;
  bench.network->put("memory:a", resource(pattern(1001)));
  const Outcome& announced = bench.load(request);
  CHECK(announced.error->kind == LoadErrorKind::too_large);
  CHECK(announced.error->message == "cannot load memory:a: it has 1001 bytes; expected at most 1000");
  script(bench, "memory:a", {[](const TransferRequest& r) {
           MemoryAnswer answer = answer_well(resource(pattern(1'000'000)), r);
           answer.head.content_length.reset();
           answer.head.encoded = true;
           return answer;
         }});
  const Outcome& bomb = bench.load(request);
  CHECK(bomb.error->kind == LoadErrorKind::too_large);
  CHECK(bomb.error->message.find("after decompression, the limit of this request") != std::string::npos);
  request.max_bytes = 1'000'000;
  CHECK(bench.load(request).events == "Hd.");
}

TEST_CASE("rejects inconsistent answers") {
  Bench bench;
  const std::string text = pattern(10'000);
  const auto lie = [&](const std::function<void(MemoryAnswer&)>& change) {
    script(bench, "memory:a", {[&text, change](const TransferRequest& r) {
             MemoryAnswer answer = answer_well(resource(text), r);
             change(answer);
             return answer;
           }});
    return bench.load(ranges_of("memory:a", {{100, 5000}}));
  };
  const auto check = [](const Outcome& got) { CHECK(got.error->kind == LoadErrorKind::bad_response); };
  check(lie([](MemoryAnswer& a) { a.head.content_range->begin = 0; }));
  check(lie([](MemoryAnswer& a) {
    a.head.content_range->end = 9000;
    a.head.content_length.reset();
  }));
  check(lie([](MemoryAnswer& a) { a.head.content_range.reset(); }));
  check(lie([](MemoryAnswer& a) { a.head.encoded = true; }));
  check(lie([](MemoryAnswer& a) { a.head.content_length = 3; }));
  check(lie([](MemoryAnswer& a) { a.head.content_type = "multipart/byteranges; boundary=x"; }));
  check(lie([](MemoryAnswer& a) { a.head.status = 304; }));
  const Outcome longer = lie([](MemoryAnswer& a) { a.body.resize(6000); });
  CHECK(longer.error->message == "cannot load memory:a: the server sent more than the 5000 bytes it announced");
  const Outcome shorter = lie([](MemoryAnswer& a) { a.body.resize((a.body.size() + 1) / 2); });
  CHECK(shorter.done);  // the rest was requested repeatedly
  CHECK(shorter.pieces.at(100) == text.substr(100, 4900));
  check(lie([](MemoryAnswer& a) {
    a.head.status = 206;
    a.head.content_range = ContentRange{};
  }));
}

TEST_CASE("reports an error for a server that only sends empty parts") {
  Bench bench;
  script(bench, "memory:a", {[](const TransferRequest& r) {
           MemoryAnswer answer = answer_well(resource(pattern(1000)), r);
           answer.body.clear();
           return answer;
         }});
  const Outcome& got = bench.load("memory:a");
  CHECK(got.error->kind == LoadErrorKind::broken);
  CHECK(got.error->message ==
        "cannot load memory:a: the connection ended after byte 0; expected 1000 (after 7 attempts)");
  // One byte per transfer counts as progress, but not endlessly.
  script(bench, "memory:b", {[](const TransferRequest& r) {
           MemoryAnswer answer = answer_well(resource(pattern(1000)), r);
           answer.break_after = 1;
           return answer;
         }});
  CHECK(bench.load("memory:b").error->message.find("(after 30 attempts)") != std::string::npos);
}

}  // namespace
