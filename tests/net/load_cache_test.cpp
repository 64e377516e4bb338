#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/net/load_helpers.h"

/// The loader with its cache, over the memory transport.
namespace {

using namespace gs::net;
using namespace gs::net::test;

class CacheBench {
 public:
  CacheBench() { start(); }
  /// Starts again, as after a restart of the program.
  void start() {
    const std::vector<TransferRequest> seen = bench ? bench->network->transfers() : std::vector<TransferRequest>();
    const std::int64_t unix_start = bench ? bench->options.unix_seconds() : 1'700'000'000;
    bench.reset();
    auto random = [state = ++seed_]() mutable { return state = state * 6364136223846793005u + 1442695040888963407u; };
    auto cache = HttpCache::open({folder.path(), 1 << 26, 100, 0, random}, unix_start);
    bench.emplace(LoaderOptions{}, std::move(std::get<std::unique_ptr<HttpCache>>(cache)));
    bench->unix_start = unix_start;
  }
  void put(const std::string& text, const std::string& etag, std::optional<std::int64_t> max_age,
           bool no_store = false) {
    MemoryResource resource;
    resource.bytes = bytes_of(text);
    resource.validator.etag = etag;
    resource.cache_control.max_age = max_age;
    resource.cache_control.no_store = no_store;
    bench->network->put("memory:a", resource);
  }
  Outcome load(std::vector<ByteRange> ranges = {}) {
    Request request;
    request.url = "memory:a";
    request.ranges = std::move(ranges);
    return bench->load(request);
  }
  [[nodiscard]] std::size_t asked() const { return bench->network->transfers().size(); }

  TemporaryFolder folder;
  std::optional<Bench> bench;

 private:
  std::uint64_t seed_ = 0;
};

TEST_CASE("delivers the bytes of a range in order if the cache has some of them") {
  for (const std::optional<std::int64_t> max_age : {std::optional<std::int64_t>(60), std::optional<std::int64_t>()}) {
    CacheBench cache;
    const std::string text = pattern(300'000);
    cache.put(text, "\"1\"", max_age);
    cache.load({{1000, 20'000}, {60'000, 90'000}, {120'000, 150'000}, {299'000, 300'000}});
    const std::size_t before = cache.asked();
    const Outcome got = cache.load({{500, 300'000}});
    CHECK(got.events == "Hd.");
    CHECK(got.in_order);
    CHECK(got.pieces == std::map<std::uint64_t, std::string>{{500, text.substr(500)}});
    std::uint64_t asked = 0;
    for (std::size_t i = before; i < cache.asked(); ++i) asked += cache.bench->network->transfers()[i].range->size();
    CHECK(asked == 300'000 - 500 - 19'000 - 30'000 - 30'000 - 1000);
    const Outcome two = cache.load({{100, 700}, {59'000, 61'000}});
    CHECK(two.pieces == std::map<std::uint64_t, std::string>{{100, text.substr(100, 600)},
                                                             {59'000, text.substr(59'000, 2000)}});
  }
}

TEST_CASE("serves fresh resources from the cache without a request") {
  CacheBench cache;
  const std::string text = pattern(300'000);
  cache.put(text, "\"1\"", 60);
  CHECK_FALSE(cache.load().head.from_cache);
  const Outcome again = cache.load();
  CHECK(again.events == "Hd.");
  CHECK(again.head.from_cache);
  CHECK(again.text() == text);
  CHECK(again.in_order);
  CHECK(cache.load({{100, 200}, {250'000, 250'010}}).pieces.at(250'000) == text.substr(250'000, 10));
  CHECK(cache.asked() == 1);
  cache.start();
  CHECK(cache.load().text() == text);
  CHECK(cache.asked() == 0);
}

TEST_CASE("confirms stale resources by ETag") {
  CacheBench cache;
  const std::string text = pattern(300'000);
  cache.put(text, "\"1\"", std::nullopt);
  cache.load();
  const Outcome again = cache.load();
  CHECK(again.head.from_cache);
  CHECK(again.text() == text);
  CHECK(cache.bench->network->transfers().at(1).if_none_match == "\"1\"");
  CHECK_FALSE(cache.bench->network->transfers().at(1).range);

  const std::string other = pattern(200'000, 5);
  cache.put(other, "\"2\"", std::nullopt);
  const Outcome changed = cache.load();
  CHECK(changed.events == "Hd.");
  CHECK_FALSE(changed.head.from_cache);
  CHECK(changed.text() == other);
  CHECK(cache.load().text() == other);
}

TEST_CASE("confirms a whole resource by a weak ETag, but stores no parts for it") {
  CacheBench cache;
  const std::string text = pattern(100'000);
  cache.put(text, "W/\"1\"", std::nullopt);
  cache.load({{0, 1000}});
  cache.load();
  CHECK_FALSE(cache.bench->outcomes.rbegin()->second.head.from_cache);
  CHECK(cache.load().head.from_cache);
}

TEST_CASE("stores nothing with no-store") {
  CacheBench cache;
  cache.put("abc", "\"1\"", 60, true);
  cache.load();
  CHECK_FALSE(cache.load().head.from_cache);
  for (const auto& entry : std::filesystem::directory_iterator(cache.folder.path()))
    CHECK(entry.path().filename() == "lock");
}

TEST_CASE("requests only missing bytes") {
  CacheBench cache;
  const std::string text = pattern(300'000);
  cache.put(text, "\"1\"", 60);
  cache.load({{0, 10'000}});
  cache.load({{100'000, 110'000}});
  const Outcome got = cache.load({{5000, 20'000}, {100'000, 110'000}});
  CHECK(got.pieces.at(5000) == text.substr(5000, 15'000));
  CHECK(got.pieces.at(100'000) == text.substr(100'000, 10'000));
  REQUIRE(cache.asked() == 3);
  CHECK(cache.bench->network->transfers().at(2).range == ByteRange{10'000, 20'000});
  CHECK(cache.bench->network->transfers().at(2).if_range == "\"1\"");
  const Outcome whole = cache.load();
  CHECK(whole.text() == text);
  CHECK(whole.in_order);
  CHECK(cache.bench->network->transfers().at(3).range->begin == 20'000);
  CHECK(cache.load().head.from_cache);
  CHECK(cache.asked() == 4);
}

TEST_CASE("reuses the bytes of a cancelled request and confirms them first if stale") {
  CacheBench cache;
  const std::string text = pattern(300'000);
  MemoryResource resource;
  resource.bytes = bytes_of(text);
  resource.validator.etag = "\"1\"";
  cache.bench->network->put("memory:a", [resource](const TransferRequest& request, unsigned) {
    MemoryAnswer answer = answer_well(resource, request);
    answer.bytes_per_second = 100'000;
    return answer;
  });
  const RequestId id = cache.bench->request("memory:a");
  cache.bench->run(Milliseconds(1500));
  cache.bench->cancel(id);
  SECTION("it goes on") {
    const Outcome got = cache.load();
    CHECK(got.events == "Hd.");
    CHECK(got.text() == text);
    CHECK(got.in_order);
    CHECK(got.head.from_cache);
    const auto second = cache.bench->network->transfers().at(1);
    CHECK(second.range->begin > 100'000);
    CHECK(second.if_range == "\"1\"");
  }
  SECTION("unless it has changed meanwhile") {
    const std::string other = pattern(200'000, 3);
    cache.put(other, "\"2\"", std::nullopt);
    const Outcome got = cache.load();
    CHECK(got.events == "Hd.");
    CHECK(got.text() == other);
    CHECK_FALSE(got.head.from_cache);
  }
}

TEST_CASE("withdraws fresh parts if the rest belongs to another version") {
  CacheBench cache;
  const std::string text = pattern(300'000), other = pattern(300'000, 1);
  cache.put(text, "\"1\"", 60);
  cache.load({{0, 100'000}});
  cache.put(other, "\"2\"", 60);
  const Outcome got = cache.load({{50'000, 150'000}});
  CHECK(got.events == "HdRHd.");
  CHECK(got.pieces.at(50'000) == other.substr(50'000, 100'000));
}

TEST_CASE("requests again what is damaged in the cache") {
  CacheBench cache;
  const std::string text = pattern(300'000);
  cache.put(text, "\"1\"", 60);
  cache.load();
  for (const auto& entry : std::filesystem::directory_iterator(cache.folder.path()))
    if (entry.path().extension() == ".data") {
      std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
      file.seekp(200'000);
      file.put('\x01');
    }
  const Outcome got = cache.load();
  CHECK(got.text() == text);
  CHECK(got.done);
  CHECK(cache.asked() == 2);
  CHECK(cache.load().text() == text);
  CHECK(cache.asked() == 2);
}

TEST_CASE("asks the server on reload, and writes nothing with never_store") {
  CacheBench cache;
  cache.put("abc", "\"1\"", 60);
  Request request;
  request.url = "memory:a";
  request.cache = CacheUse::never_store;
  cache.bench->load(request);
  CHECK_FALSE(cache.load().head.from_cache);
  request.cache = CacheUse::reload;
  CHECK_FALSE(cache.bench->load(request).head.from_cache);
  CHECK(cache.load().head.from_cache);
  request.accept = "image/png";
  request.cache = CacheUse::normal;
  CHECK_FALSE(cache.bench->load(request).head.from_cache);  // another request
}

TEST_CASE("limits cached bytes that wait for a slow owner") {
  CacheBench cache;
  const std::string text = pattern(6'000'000);
  cache.put(text, "\"1\"", 60);
  CHECK(cache.load().text() == text);
  const RequestId id = cache.bench->request("memory:a");
  cache.bench->run(Milliseconds(10), false);
  CHECK(cache.bench->queue->queued_bytes() <= std::size_t{4} << 20);
  CHECK(cache.bench->queue->queued_bytes() > 1'000'000);
  cache.bench->run();
  CHECK(cache.bench->outcomes[id].text() == text);
}

TEST_CASE("sends the signature of a presigned URL with each range, and caches the object without it") {
  CacheBench cache;
  const std::string text = pattern(300'000), object = "memory://store/a.qnv?versionId=3";
  const auto url = [&](const std::string& signature) {
    return object + "&X-Amz-Credential=K%2Fs3&X-Amz-Expires=900&X-Amz-Signature=" + signature;
  };
  for (const char* const signature : {"first", "second"}) {
    MemoryResource resource;
    resource.bytes = bytes_of(text);
    resource.validator.etag = "\"1\"";
    cache.bench->network->put(url(signature), resource);
  }
  const auto load = [&](const std::string& signature, std::vector<ByteRange> ranges) {
    Request request;
    request.url = url(signature);
    request.ranges = std::move(ranges);
    return cache.bench->load(request);
  };
  CHECK_FALSE(load("first", {{0, 50'000}, {100'000, 120'000}}).error);
  const Outcome again = load("second", {{0, 60'000}});
  CHECK(again.pieces.at(0) == text.substr(0, 60'000));
  for (const TransferRequest& transfer : cache.bench->network->transfers())
    CHECK(transfer.url.find("&X-Amz-Credential=K%2Fs3&X-Amz-Expires=900&X-Amz-Signature=") != std::string::npos);
  const TransferRequest last = cache.bench->network->transfers().back();
  CHECK(last.url == url("second"));
  REQUIRE(last.range);
  CHECK(last.range->begin == 50'000);
  // No file of the cache holds a signature.
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(cache.folder.path())) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    CHECK(bytes.find("X-Amz") == std::string::npos);
    ++files;
  }
  CHECK(files > 0);
  const Outcome failed = load("expired", {{0, 10}});
  REQUIRE(failed.error);
  CHECK(failed.error->message.find("versionId=3") != std::string::npos);
  CHECK(failed.error->message.find("expired") == std::string::npos);
}

}  // namespace
