#include "net/http/http_cache.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <thread>

#include "tests/net/load_helpers.h"

namespace {

using namespace gs::net;
using gs::net::test::bytes_of;
using gs::net::test::pattern;
using gs::net::test::TemporaryFolder;
namespace fs = std::filesystem;

std::unique_ptr<HttpCache> open(const std::string& folder, std::uint64_t bytes = 1 << 24, std::size_t entries = 64,
                                std::uint64_t seed = 1) {
  auto random = [state = seed]() mutable { return state = state * 6364136223846793005u + 1442695040888963407u; };
  auto opened = HttpCache::open({folder, bytes, entries, 0, random}, 1000);
  return std::move(std::get<std::unique_ptr<HttpCache>>(opened));
}

CachedHead head_of(const std::string& etag, std::optional<std::uint64_t> total) {
  CachedHead head;
  head.url = "http://a/";
  head.content_type = "model/vrml";
  head.validator.etag = etag;
  head.total = total;
  head.accepts_ranges = true;
  head.stored_at = 1000;
  head.fresh_for = 60;
  return head;
}

void put(HttpCache& cache, const std::string& key, const std::string& etag, const std::string& text,
         std::int64_t now = 1000) {
  const auto writer = cache.write(key, head_of(etag, text.size()));
  REQUIRE(writer);
  writer->append(0, bytes_of(text));
  writer->commit(text.size(), now);
}

std::string read(const CachedResource& resource, std::uint64_t begin, std::uint64_t end) {
  std::string result;
  while (begin < end) {
    const auto bytes = resource.read(begin, static_cast<std::size_t>(end - begin));
    if (!bytes || bytes->empty()) return "damaged";
    result.append(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    begin += bytes->size();
  }
  return result;
}

std::vector<fs::path> files(const std::string& folder, const std::string& ending) {
  std::vector<fs::path> result;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().string().ends_with(ending)) result.push_back(entry.path());
  return result;
}

TEST_CASE("finds stored resources after it is opened again") {
  const TemporaryFolder folder;
  const std::string text = pattern(300'000);
  {
    const auto cache = open(folder.path());
    CHECK_FALSE(cache->find("k", 1000));
    put(*cache, "k", "\"1\"", text);
    CHECK(cache->usage().entries == 1);
  }
  const auto cache = open(folder.path());
  const auto found = cache->find("k", 1000);
  REQUIRE(found);
  CHECK(found->complete());
  CHECK(read(*found, 0, text.size()) == text);
  CHECK(read(*found, 65530, 65550) == text.substr(65530, 20));
  CHECK_FALSE(found->read(text.size(), 1));
  CHECK(found->head().content_type == "model/vrml");
  CHECK(found->fresh(1059));
  CHECK_FALSE(found->fresh(1060));
  CHECK_FALSE(found->fresh(999));
  CHECK(cache->usage().entries == 1);
  CHECK(cache->usage().bytes >= text.size());
  CHECK((fs::status(folder.path()).permissions() & fs::perms::others_all) == fs::perms::none);
}

TEST_CASE("collects ranges of one version in one file") {
  const TemporaryFolder folder;
  const std::string text = pattern(200'000);
  const auto cache = open(folder.path());
  const auto add = [&](const std::string& etag, std::uint64_t begin, std::uint64_t end) {
    const auto writer = cache->write("k", head_of(etag, text.size()));
    REQUIRE(writer);
    writer->append(begin, bytes_of(text.substr(begin, end - begin)));
    writer->commit(std::nullopt, 1000);
  };
  add("\"1\"", 1000, 2000);
  add("\"1\"", 150'000, 160'000);
  add("\"1\"", 1500, 2500);
  auto found = cache->find("k", 1000);
  REQUIRE(found);
  CHECK_FALSE(found->complete());
  CHECK(found->present() == RangeSet(std::array{ByteRange{1000, 2500}, ByteRange{150'000, 160'000}}));
  CHECK(read(*found, 1200, 2500) == text.substr(1200, 1300));
  CHECK(files(folder.path(), ".data").size() == 1);
  add("\"1\"", 0, text.size());
  CHECK(read(*cache->find("k", 1000), 0, text.size()) == text);

  SECTION("another version replaces them all") {
    add("\"2\"", 10, 20);
    CHECK(cache->find("k", 1000)->present() == RangeSet(std::array{ByteRange{10, 20}}));
    CHECK(files(folder.path(), ".data").size() == 1);
    CHECK(read(*found, 1200, 2500) == text.substr(1200, 1300));  // a reader of the old version continues
  }
  SECTION("a part that nothing identifies is not kept") {
    add("W/\"1\"", 10, 20);
    add("", 10, 20);
    CHECK(cache->find("k", 1000)->complete());
  }
  SECTION("less of the same is not taken for more") {
    auto first = cache->write("other", head_of("\"1\"", 100)), second = cache->write("other", head_of("\"1\"", 100));
    first->append(0, bytes_of(text.substr(0, 100)));
    second->append(0, bytes_of(text.substr(0, 10)));
    first->commit(std::nullopt, 1000);
    second->commit(std::nullopt, 1000);
    CHECK(cache->find("other", 1000)->complete());
  }
}

TEST_CASE("leaves no file of an uncommitted writer") {
  const TemporaryFolder folder;
  const auto cache = open(folder.path());
  cache->write("k", head_of("\"1\"", 10))->append(0, bytes_of("abc"));
  CHECK(files(folder.path(), ".data").empty());
  CHECK_FALSE(cache->find("k", 1000));
}

TEST_CASE("detects damage and drops only the damaged entry") {
  const TemporaryFolder folder;
  const auto cache = open(folder.path());
  const std::string text = pattern(100'000);
  put(*cache, "k", "\"1\"", text);
  const fs::path data = files(folder.path(), ".data").at(0), entry = files(folder.path(), ".entry").at(0);

  SECTION("a flipped byte of the data") {
    std::fstream file(data, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(70'000);
    file.put('\x7f');
    file.close();
    const auto found = cache->find("k", 1000);
    REQUIRE(found);
    CHECK(found->read(0, 10));
    CHECK_FALSE(found->read(70'500, 10));
  }
  SECTION("data cut off") {
    fs::resize_file(data, 1000);
    CHECK_FALSE(cache->find("k", 1000)->read(0, 10));
  }
  SECTION("data gone") {
    fs::remove(data);
    CHECK_FALSE(cache->find("k", 1000));
    CHECK(files(folder.path(), ".entry").empty());
  }
  SECTION("every prefix of the entry") {
    const std::uintmax_t size = fs::file_size(entry);
    for (std::uintmax_t cut = size; cut-- > 0;) {
      fs::resize_file(entry, cut);
      CHECK_FALSE(cache->find("k", 1000));
    }
    put(*cache, "k", "\"1\"", text);
    CHECK(cache->find("k", 1000)->complete());
  }
}

TEST_CASE("rejects entries with a flipped bit, and nonsense with a right checksum") {
  CacheEntry entry;
  entry.key = "k";
  entry.data = 5;
  entry.head = head_of("\"1\"", 200);
  REQUIRE(entry.add({0, 100, 1}));
  REQUIRE(entry.add({150, 50, 2}));
  const auto bytes = write_cache_entry(entry);
  REQUIRE(read_cache_entry(bytes));
  CHECK(read_cache_entry(bytes)->extents.size() == 2);
  for (std::size_t i = 0; i < bytes.size() * 8; ++i) {
    auto damaged = bytes;
    damaged[i / 8] ^= static_cast<std::byte>(1 << (i % 8));
    CHECK_FALSE(read_cache_entry(damaged));
  }
  const auto refused = [&entry](auto change) {
    CacheEntry other = entry;
    change(other);
    return !read_cache_entry(write_cache_entry(other));
  };
  CHECK(refused([](CacheEntry& e) { e.extents[1].begin = 99; }));
  CHECK(refused([](CacheEntry& e) { e.extents[1].begin = 151; }));
  CHECK(refused([](CacheEntry& e) { e.extents[1].begin = UINT64_MAX - 10; }));
  CHECK(refused([](CacheEntry& e) { e.extents[0].size = 0; }));
  CHECK(refused([](CacheEntry& e) { e.head.stored_at = -1; }));
  CHECK(refused([](CacheEntry& e) { e.head.fresh_for = INT64_MAX; }));
}

TEST_CASE("joins neighbouring extents with their checksums") {
  const auto bytes = bytes_of(pattern(1000));
  CacheEntry entry;
  REQUIRE(entry.add({0, 400, cache_checksum(std::span(bytes).first(400))}));
  REQUIRE(entry.add({400, 600, cache_checksum(std::span(bytes).subspan(400))}));
  REQUIRE(entry.add({100, 50, 9}));  // overlaps: rejected
  REQUIRE(entry.extents.size() == 1);
  CHECK(entry.extents[0].checksum == cache_checksum(bytes));
}

TEST_CASE("removes the least recently used entries at the size limit") {
  const TemporaryFolder folder;
  const auto cache = open(folder.path(), 400'000, 1000);
  const std::string text = pattern(80'000);
  for (int i = 0; i < 4; ++i) put(*cache, "k" + std::to_string(i), "\"1\"", text, 1000 + i);
  CHECK(cache->find("k0", 1010));  // makes k1 the oldest
  put(*cache, "k4", "\"1\"", text, 1011);
  put(*cache, "k5", "\"1\"", text, 1012);
  CHECK(cache->usage().bytes <= 400'000);
  CHECK(cache->find("k0", 1013));
  CHECK_FALSE(cache->find("k1", 1013));
  CHECK(cache->find("k5", 1013));
}

TEST_CASE("limits the number of files, and the share of one entry") {
  const TemporaryFolder folder;
  const auto cache = open(folder.path(), 1 << 20, 20);
  for (int i = 0; i < 100; ++i) put(*cache, std::to_string(i), "\"1\"", "abc", 1000 + i);
  CHECK(files(folder.path(), ".entry").size() <= 20);
  CHECK(files(folder.path(), ".data").size() <= 20);
  CHECK(cache->find("99", 2000));
  const std::string large = pattern(400'000);
  const auto writer = cache->write("large", head_of("\"1\"", large.size()));
  writer->append(0, bytes_of(large.substr(0, 200'000)));
  writer->append(200'000, bytes_of(large.substr(200'000)));
  writer->commit(std::nullopt, 2000);
  CHECK(cache->find("large", 2000)->present() == RangeSet(std::array{ByteRange{0, 200'000}}));
}

TEST_CASE("removes leftovers of crashes after an hour") {
  const TemporaryFolder folder;
  const auto cache = open(folder.path());
  put(*cache, "k", "\"1\"", "abc");
  const std::string entry = files(folder.path(), ".entry").at(0).filename().string();
  const std::string name = entry.substr(0, 32);
  std::ofstream(folder / (name + "-0123456789abcdef.data")) << "x";
  std::ofstream(folder / (std::string(32, 'a') + "-0123456789abcdef.data")) << "x";
  std::ofstream(folder / (entry + ".tmp-1")) << "x";
  const auto now =
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  cache->clean(now);
  CHECK(files(folder.path(), ".data").size() == 3);
  cache->clean(now + 4000);
  CHECK(files(folder.path(), ".data").size() == 1);
  CHECK(files(folder.path(), ".tmp-1").empty());
  CHECK(cache->find("k", 1000));
}

TEST_CASE("shares one folder between two caches") {
  const TemporaryFolder folder;
  const std::string text = pattern(64'000);
  // Shares no memory, like two processes.
  const auto work = [&](std::uint64_t seed) {
    const auto cache = open(folder.path(), 300'000, 8, seed);
    std::uint64_t state = seed;
    for (int i = 0; i < 150; ++i) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      const std::string key = std::to_string(state >> 60);
      const std::uint64_t begin = (state >> 20) % 60'000, end = begin + 4000;
      const auto writer = cache->write(key, head_of("\"1\"", text.size()));
      if (writer) {
        writer->append(begin, bytes_of(text.substr(begin, end - begin)));
        writer->commit(std::nullopt, 1000 + i);
      }
      const auto found = cache->find(key, 1000 + i);
      if (!found) continue;
      for (const ByteRange& range : found->present().ranges())
        if (read(*found, range.begin, range.end) != text.substr(range.begin, range.size())) return false;
      if (i % 20 == 0) cache->drop(key);
    }
    return true;
  };
  bool first = false, second = false;
  std::thread thread([&] { first = work(1); });
  second = work(2);
  thread.join();
  CHECK(first);
  CHECK(second);
  CHECK(files(folder.path(), ".tmp").empty());
}

TEST_CASE("marks a confirmed entry as fresh") {
  const TemporaryFolder folder;
  const auto cache = open(folder.path());
  put(*cache, "k", "\"1\"", "abc");
  cache->confirm("k", {"\"2\"", "", false}, 100, 2000);
  CHECK_FALSE(cache->find("k", 2000)->fresh(2000));
  cache->confirm("k", {"\"1\"", "", false}, 100, 2000);
  CHECK(cache->find("k", 2000)->fresh(2099));
}

TEST_CASE("returns an error for a folder that cannot be used") {
  const TemporaryFolder folder;
  std::ofstream(folder / "f") << "x";
  const auto opened = HttpCache::open({folder / "f/g", 1 << 20, 8, 0, [] { return std::uint64_t{1}; }}, 0);
  REQUIRE(std::holds_alternative<FileError>(opened));
  CHECK(std::get<FileError>(opened).message.starts_with("cannot use " + (folder / "f/g") + " as cache: "));
}

}  // namespace
