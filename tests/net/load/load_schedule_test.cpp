#include "net/load/load_engine.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>

#include "tests/net/load_helpers.h"

namespace {

using namespace gs::net;
using namespace gs::net::test;

TEST_CASE("limits queued bytes while the owner does not poll") {
  LoaderOptions options;
  options.max_queued_bytes = 300'000;
  options.max_queued_bytes_per_request = 100'000;
  Bench bench(options);
  const std::string text = pattern(2'000'000);
  for (int i = 0; i < 10; ++i) bench.network->put("memory:" + std::to_string(i), resource(text));
  for (int i = 0; i < 10; ++i) bench.request("memory:" + std::to_string(i));
  bench.run(Milliseconds(1000), false);
  CHECK(bench.queue->queued_bytes() >= 200'000);
  CHECK(bench.queue->queued_bytes() <= 300'000 + 10 * 16384);
  CHECK(bench.queue->clear_starved());
  std::size_t most = 0;
  const auto all_ended = [&bench] {
    const auto ended = [](const auto& each) { return each.second.ended(); };
    return bench.outcomes.size() == 10 && std::all_of(bench.outcomes.begin(), bench.outcomes.end(), ended);
  };
  for (int i = 0; i < 10'000 && !all_ended(); ++i) {
    bench.poll(50'000);
    bench.engine->step(bench.now);
    most = std::max(most, bench.queue->queued_bytes());
  }
  bench.poll();
  CHECK(most <= 300'000 + 10 * 16384);
  for (auto& [id, outcome] : bench.outcomes) CHECK(outcome.text() == text);
  CHECK(bench.outcomes.size() == 10);
}

TEST_CASE("starts the most urgent requests first, and accepts changed priorities") {
  LoaderOptions options;
  options.max_transfers = 1;
  Bench bench(options);
  std::vector<std::string> order;
  const auto put = [&](const std::string& name) {
    bench.network->put("memory:" + name, [&order, name](const TransferRequest& r, unsigned) {
      order.push_back(name);
      MemoryAnswer answer = answer_well(resource("abc"), r);
      answer.latency = Milliseconds(10);
      return answer;
    });
    Request request;
    request.url = "memory:" + name;
    return request;
  };
  std::map<std::string, RequestId> ids;
  for (const auto& [name, priority] :
       std::vector<std::pair<std::string, int>>{{"a", 1}, {"b", 3}, {"c", 2}, {"d", 0}, {"e", 2}}) {
    Request request = put(name);
    request.priority = priority;
    ids[name] = bench.request(request);
  }
  bench.engine->set_priority(ids["d"], 5);
  bench.run();
  CHECK(order == std::vector<std::string>{"d", "b", "c", "e", "a"});
}

TEST_CASE("serves viewports in turn at equal priority") {
  LoaderOptions options;
  options.max_transfers = 2;
  Bench bench(options);
  std::string order;
  for (int i = 0; i < 8; ++i) {
    const std::string url = "memory:" + std::to_string(i);
    const char viewport = i < 6 ? 'a' : 'b';
    bench.network->put(url, [&order, viewport](const TransferRequest& r, unsigned) {
      order += viewport;
      MemoryAnswer answer = answer_well(resource("abc"), r);
      answer.latency = Milliseconds(10);
      return answer;
    });
    Request request;
    request.url = url;
    request.viewport = static_cast<std::uint32_t>(viewport);
    bench.request(request);
  }
  bench.run();
  CHECK(order == "ababaaaa");
}

TEST_CASE("pauses a running transfer for an urgent one, and resumes it") {
  LoaderOptions options;
  options.max_transfers = 1;
  Bench bench(options);
  const std::string text = pattern(200'000);
  for (const char* url : {"memory:slow", "memory:urgent"})
    bench.network->put(url, [&text](const TransferRequest& r, unsigned) {
      MemoryAnswer answer = answer_well(resource(text), r);
      answer.bytes_per_second = 100'000;
      return answer;
    });
  const RequestId slow = bench.request("memory:slow");
  bench.run(Milliseconds(500));
  const std::uint64_t before = bench.outcomes[slow].received;
  CHECK(before > 0);
  Request urgent;
  urgent.url = "memory:urgent";
  urgent.priority = 1;
  const RequestId id = bench.request(urgent);
  bench.run(Milliseconds(1000));
  CHECK(bench.outcomes[slow].received <= before + 16384);
  CHECK(bench.outcomes[id].received > 50'000);
  bench.run();
  CHECK(bench.outcomes[id].text() == text);
  CHECK(bench.outcomes[slow].text() == text);
  CHECK(bench.network->transfers().size() == 2);  // requested nothing twice
}

TEST_CASE("limits concurrent transfers per host and in total") {
  LoaderOptions options;
  options.max_transfers = 8;
  options.max_transfers_per_host = 3;
  Bench bench(options);
  for (int i = 0; i < 40; ++i) {
    const std::string url = "memory://host" + std::to_string(i % 5) + "/" + std::to_string(i);
    bench.network->put(url, [](const TransferRequest& r, unsigned) {
      MemoryAnswer answer = answer_well(resource("abc"), r);
      answer.latency = Milliseconds(1000);
      return answer;
    });
    bench.request(url);
  }
  bench.run(Milliseconds(500));
  std::map<std::string, int> hosts;
  for (const auto& transfer : bench.network->transfers()) ++hosts[transfer.url.substr(0, 14)];
  CHECK(bench.network->transfers().size() == 8);
  for (const auto& [host, count] : hosts) CHECK(count <= 3);
  bench.run();
  CHECK(bench.network->transfers().size() == 40);
}

TEST_CASE("delivers nothing after a cancellation") {
  Bench bench;
  bench.network->put("memory:a", [](const TransferRequest& r, unsigned) {
    MemoryAnswer answer = answer_well(resource(pattern(100'000)), r);
    answer.bytes_per_second = 10'000;
    return answer;
  });
  const RequestId id = bench.request("memory:a");
  bench.run(Milliseconds(3000));
  const std::uint64_t received = bench.outcomes[id].received;
  CHECK(received > 0);
  bench.engine->step(bench.now += Milliseconds(2000));
  bench.cancel(id);
  bench.run();
  CHECK(bench.outcomes[id].received == received);
  CHECK(bench.queue->queued_bytes() == 0);
  bench.cancel(id);
}

TEST_CASE("loads whole files and ranges, and reports folders and changes") {
  const TemporaryFolder folder;
  const std::string text = pattern(1'000'000);
  const std::string path = folder / "f";
  std::ofstream(path, std::ios::binary) << text;
  Bench bench;
  const std::string url = url_of_path(path).text();
  const Outcome& all = bench.load(url);
  CHECK(all.events == "Hd.");
  CHECK(all.text() == text);
  CHECK(all.head.total == text.size());
  CHECK_FALSE(all.head.validator.strong().empty());
  CHECK(bench.load(ranges_of(url, {{10, 20}, {500'000, 500'010}})).pieces.at(500'000) == text.substr(500'000, 10));
  CHECK(bench.load(ranges_of(url, {{1'000'000, 1'000'001}})).error->kind == LoadErrorKind::bad_request);
  const Outcome& none = bench.load(url + "x");
  CHECK(none.error->kind == LoadErrorKind::not_found);
  CHECK(none.error->message == "cannot load " + url + "x: No such file or directory");
  CHECK(bench.load(url_of_path(folder.path()).text()).error->message.ends_with("it is a folder; expected a file"));
  CHECK(bench.load("file:///dev/zero").error->kind == LoadErrorKind::unreadable);
  CHECK(bench.load("file://host/f").error->kind == LoadErrorKind::bad_request);

  LoaderOptions options;
  options.max_queued_bytes = options.max_queued_bytes_per_request = 200'000;
  Bench slow(options);
  const RequestId id = slow.request(url);
  slow.run(Milliseconds(0), false);
  slow.poll(1000);
  const std::string other = pattern(900'000, 3);
  std::ofstream(path, std::ios::binary) << other;
  slow.run();
  CHECK(slow.outcomes[id].events == "HdRHd.");
  CHECK(slow.outcomes[id].text() == other);
}

TEST_CASE("loads data URLs like other resources") {
  Bench bench;
  const Outcome& got = bench.load("data:model/vrml,#VRML V2.0 utf8%0a");
  CHECK(got.text() == "#VRML V2.0 utf8\n");
  CHECK(got.head.content_type == "model/vrml");
  CHECK(bench.load(ranges_of("data:,0123456789", {{2, 4}})).pieces.at(2) == "23");
  CHECK(bench.load("data:x").error->message ==
        "cannot load data:x: malformed data: URL; expected data:[type][;base64],content (RFC 2397)");
}

}  // namespace
