#include <catch2/catch.hpp>

#include <atomic>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "net/limits/client_limits.h"
#include "net/serve/access_log.h"
#include "net/serve/http_range.h"
#include "net/serve/http_site.h"
#include "net/serve/made_files.h"
#include "net/serve/served_folder.h"

using namespace gs::net;

namespace {

using Ranges = std::vector<ServedRange>;

Ranges served_ranges(std::string_view value, std::uint64_t size) {
  const auto parsed = parse_ranges(value, size);
  const auto* ranges = std::get_if<Ranges>(&parsed);
  return ranges ? *ranges : Ranges{};
}

ClientKey key_of(std::uint8_t last) {
  ClientKey key{};
  key[15] = last;
  return key;
}

}  // namespace

TEST_CASE("joins ranges where that is cheaper, and keeps their order") {
  CHECK(served_ranges("bytes=0-0", 1) == Ranges{{0, 1}});
  CHECK(served_ranges("BYTES = 0-0 , ,5000-5001", 9000) == Ranges{{0, 1}, {5000, 5002}});
  CHECK(served_ranges("bytes=5000-5001,0-0", 9000) == Ranges{{5000, 5002}, {0, 1}});
  CHECK(served_ranges("bytes=0-9,1000-1009,5-1004", 9000) == Ranges{{0, 1010}});
  CHECK(served_ranges("bytes=0-9,129-130", 9000) == Ranges{{0, 131}});
  CHECK(served_ranges("bytes=0-9,130-131", 9000) == Ranges{{0, 10}, {130, 132}});
  CHECK(served_ranges("bytes=-5,9990-", 10000) == Ranges{{9990, 10000}});
  CHECK(served_ranges("bytes=18446744073709551614-18446744073709551615", UINT64_MAX) ==
        Ranges{{UINT64_MAX - 1, UINT64_MAX}});
  CHECK(std::holds_alternative<NoSuchRange>(parse_ranges("bytes=0-", 0)));
  CHECK(std::holds_alternative<NoSuchRange>(parse_ranges("bytes=-5", 0)));
  const std::string all = "bytes=1-2, -7,9-";
  for (std::size_t length = 0; length <= all.size(); ++length) (void)parse_ranges(all.substr(0, length), 100);
}

TEST_CASE("parses Accept-Encoding (RFC 9110)") {
  for (const char* yes : {"gzip", "deflate, GZIP", "x-gzip", "*", "gzip;q=0.001", "br;q=1, gzip ; q=0.5"})
    CHECK(accepts_gzip(yes));
  for (const char* no : {"", "identity", "gzip;q=0", "gzip;q=0.000", "*;q=0", "*, gzip;q=0", "gzipped", "br"})
    CHECK_FALSE(accepts_gzip(no));
}

TEST_CASE("writes and parses HTTP dates") {
  CHECK(http_date(784111777) == "Sun, 06 Nov 1994 08:49:37 GMT");
  CHECK(http_date(0) == "Thu, 01 Jan 1970 00:00:00 GMT");
}

TEST_CASE("escapes line breaks and controls in the log") {
  AccessRecord record{"192.0.2.1", "GET", "/a\" 200\n\\\xff", "HTTP/1.1", 971211336, 404, 9, 0.25};
  CHECK(log_line(record) ==
        "192.0.2.1 - - [10/Oct/2000:20:55:36 +0000] \"GET /a\\x22 "
        "200\\x0a\\x5c\\xff HTTP/1.1\" 404 9 0.250\n");
}

TEST_CASE("decodes the paths of requests once, and encodes them again") {
  const auto parsed = parse_request_path("/a%20b/%2541/");
  const auto& path = std::get<RequestPath>(parsed);
  CHECK(path.names == std::vector<std::string>{"a b", "%41"});
  CHECK(path.folder);
  CHECK(path.text() == "/a%20b/%2541/");
  CHECK(std::get<RequestPath>(parse_request_path("/")).text() == "/");
  CHECK(std::get<PathRefusal>(parse_request_path("a")).status == 400);
  CHECK(std::get<PathRefusal>(parse_request_path("")).status == 400);
}

TEST_CASE("schedules clients in turn, then their transfers") {
  HttpLimits limits;
  limits.total_rate = 64 * 1460;
  ClientLimits turns(limits, Instant(0));
  REQUIRE(turns.paced());
  CHECK(turns.piece() == 1460);
  for (ClientLimits::TransferId id : {1, 2, 3}) turns.wait(key_of(1), id, Instant(0));
  turns.wait(key_of(2), 9, Instant(0));
  std::vector<ClientLimits::TransferId> order;
  Instant now(0);
  while (turns.deadline(now) != Instant::max()) {
    now = std::max(now, turns.deadline(now));
    const auto turn = turns.next(now);
    REQUIRE(turn);
    order.push_back(*turn);
  }
  CHECK(order == std::vector<ClientLimits::TransferId>{1, 9, 2, 3});
  // The first two pieces pass immediately, the others at the rate of 64 per second.
  CHECK(now == Instant(31'250));
  CHECK_FALSE(turns.next(now + Instant(1'000'000)));
}

TEST_CASE("delays only the client that exceeds its rate") {
  HttpLimits limits;
  limits.client_rate = 64 * 1460;
  ClientLimits turns(limits, Instant(0));
  for (ClientLimits::TransferId id = 0; id < 10; ++id) turns.wait(key_of(1), id, Instant(0));
  CHECK(turns.next(Instant(0)) == 0U);
  CHECK(turns.next(Instant(0)) == 1U);
  CHECK_FALSE(turns.next(Instant(0)));
  turns.wait(key_of(2), 99, Instant(0));
  CHECK(turns.next(Instant(0)) == 99U);
}

TEST_CASE("counts requests and connections per client") {
  HttpLimits limits;
  limits.requests_per_second = 2;
  limits.connections = 3;
  limits.connections_of_client = 2;
  ClientLimits counts(limits, Instant(0));
  CHECK(counts.open(key_of(1), false, Instant(0)));
  CHECK(counts.open(key_of(1), false, Instant(0)));
  CHECK_FALSE(counts.open(key_of(1), false, Instant(0)));
  CHECK(counts.open(key_of(2), false, Instant(0)));
  CHECK_FALSE(counts.open(key_of(3), false, Instant(0)));
  counts.close(key_of(1), false, Instant(0));
  CHECK(counts.open(key_of(3), false, Instant(0)));
  for (int i = 0; i < 4; ++i) CHECK(counts.admit(key_of(1), Instant(0)));
  CHECK_FALSE(counts.admit(key_of(1), Instant(0)));
  CHECK(counts.admit(key_of(2), Instant(0)));
  CHECK_FALSE(counts.admit(key_of(1), Instant(400'000)));
  CHECK(counts.admit(key_of(1), Instant(500'000)));
}

TEST_CASE("limits clients behind a proxy by requests, the proxy's connections count only towards the total") {
  HttpLimits limits;
  limits.connections = 5;
  limits.connections_of_client = 2;
  ClientLimits counts(limits, Instant(0));
  for (int i = 0; i < 5; ++i) CHECK(counts.open(key_of(9), true, Instant(0)));
  CHECK_FALSE(counts.open(key_of(9), true, Instant(0)));
  CHECK_FALSE(counts.open(key_of(1), false, Instant(0)));
  CHECK(counts.connections() == 5);
  CHECK(counts.begin(key_of(1), Instant(0)));
  CHECK(counts.begin(key_of(1), Instant(0)));
  CHECK_FALSE(counts.begin(key_of(1), Instant(0)));
  CHECK(counts.begin(key_of(2), Instant(0)));
  counts.end(key_of(1), Instant(0));
  CHECK(counts.begin(key_of(1), Instant(0)));
  for (int i = 0; i < 5; ++i) counts.close(key_of(9), true, Instant(0));
  CHECK(counts.connections() == 0);
  // Requests through a proxy count together with the client's direct ones.
  CHECK_FALSE(counts.open(key_of(1), false, Instant(0)));
  CHECK(counts.connections() == 0);
}

TEST_CASE("retries failed files and sooner if the source is not the cause") {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("ghostspace-again-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  // One folder belongs to a killed server, one to a running server.
  fs::create_directories(folder / "making-abcdef");
  fs::permissions(folder / "making-abcdef", fs::perms::owner_all);
  std::ofstream(folder / "making-abcdef" / "made.bin") << "half";
  {
    std::atomic<std::int64_t> now{0};
    MadeFiles::Options options;
    options.folder = folder.string();
    options.now = [&now] { return Instant(now.load()); };
    MadeFiles made(options, {1}, [] {});
    CHECK_FALSE(fs::exists(folder / "making-abcdef"));
    std::atomic<int> tries{0};
    const auto state = [&](const std::string& key, bool lasting) {
      const auto fail = [&tries, lasting](const std::string& out, const std::stop_token&) {
        ++tries;
        std::ofstream(out) << "half";
        return std::optional(MakeFailure{"no", lasting});
      };
      MadeFile found = made.request(0, key, ".bin", fail);
      if (found.state != MadeState::waiting) return found.state;
      while (made.is_waiting(0, key)) ::usleep(1000);
      return made.request(0, key, ".bin", fail).state;
    };
    CHECK(state("full", false) == MadeState::failed);
    CHECK(state("bad", true) == MadeState::failed);
    CHECK(state("full", false) == MadeState::failed);
    CHECK(tries == 2);
    now = 3'000'000;
    CHECK(state("full", false) == MadeState::failed);
    CHECK(tries == 3);
    CHECK(state("bad", true) == MadeState::failed);
    CHECK(tries == 3);
    now = std::int64_t{601} * 1'000'000;
    CHECK(state("bad", true) == MadeState::failed);
    CHECK(tries == 4);
  }
  CHECK(fs::is_empty(folder));
  fs::remove_all(folder);
}

TEST_CASE("names files in messages relative to the served folder") {
  CHECK(message_for_clients("/srv/www/a/b.stl:1:2: error: no mesh", "/srv/www") == "a/b.stl:1:2: error: no mesh");
  CHECK(message_for_clients("cannot open '/srv/www/b.png' of /srv/www/a", "/srv/www") == "cannot open 'b.png' of a");
  CHECK(message_for_clients("3 and/or 4", "/srv/www") == "3 and/or 4");
  const std::string hidden = "it cannot be read; the server's log has the reason";
  for (const char* message : {"/etc/passwd", "cannot open /srv/wwwx/a", "x (/tmp/a)", "a=/b", "see http://x/",
                              "/srv/www/a and /srv/b", "'/'"})
    CHECK(message_for_clients(message, "/srv/www") == hidden);
}

TEST_CASE("limits the folder of made files, and leaves other files alone") {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("ghostspace-made-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "others.txt") << std::string(5000, 'x');
  {
    MadeFiles::Options options;
    options.folder = folder.string();
    options.most_bytes = 2500;
    options.most_waiting = 8;
    MadeFiles made(options, {1}, [] {});
    const auto make = [](const std::string& out, const std::stop_token&) -> std::optional<MakeFailure> {
      std::ofstream(out) << std::string(1000, 'x');
      return std::nullopt;
    };
    for (const std::string key : {"a", "b", "c", "d"}) {
      CHECK(made.request(0, key, ".bin", make).state == MadeState::waiting);
      while (made.is_waiting(0, key)) ::usleep(1000);
      CHECK(made.request(0, key, ".bin", make).state == MadeState::ready);
    }
    // The maker thread cleans up after each file. A second request ensures that the first one is complete.
    CHECK(made.request(0, "bad", ".bin", [](const std::string&, const std::stop_token&) { return MakeFailure{"no"}; })
              .state == MadeState::waiting);
    while (made.is_waiting(0, "bad")) ::usleep(1000);
    CHECK(made.request(0, "bad", ".bin", make).failure.message == "no");
    CHECK(made.request(0, "d", ".bin", make).state == MadeState::ready);
    CHECK(made.statistics(0).made == 4);
  }
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) files += entry.is_regular_file() ? 1 : 0;
  CHECK(files == 3);
  CHECK(fs::exists(folder / "others.txt"));
  fs::remove_all(folder);
}

TEST_CASE("makes a file again after its folder was removed") {
  namespace fs = std::filesystem;
  const auto folder = fs::temp_directory_path() / ("ghostspace-made-" + std::to_string(::getpid())) / "inner";
  fs::create_directories(folder);
  {
    MadeFiles::Options options;
    options.folder = folder.string();
    MadeFiles made(options, {1}, [] {});
    const auto make = [](const std::string& out, const std::stop_token&) -> std::optional<MakeFailure> {
      std::ofstream(out) << "x";
      return std::nullopt;
    };
    for (int i = 0; i < 2; ++i) {
      CHECK(made.request(0, "a", ".bin", make).state == MadeState::waiting);
      while (made.is_waiting(0, "a")) ::usleep(1000);
      CHECK(made.request(0, "a", ".bin", make).state == MadeState::ready);
      fs::remove_all(folder.parent_path());
    }
  }
}
