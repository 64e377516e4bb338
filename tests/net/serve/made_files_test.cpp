#include "tests/net/served_site.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/xattr.h>

using namespace gs::net;
using namespace gs::net::test;

TEST_CASE("HTTP server: two servers send equal tags for a copied file, and for equal made files") {
  ServedSite sites[2];
  const std::string source = binary_pattern(3000);
  const auto changed = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  std::string version = "1";
  for (ServedSite& site : sites) {
    site.write("a.stl", source);
    std::filesystem::last_write_time(site.path("a.stl"), changed);
    site.options.made_folder = site.made();
    Maker maker;
    maker.name = "encode";
    maker.extension = ".qnv";
    maker.for_missing = true;
    maker.source_of = [](const std::string& name, const std::string&) -> std::optional<std::string> {
      if (!name.ends_with(".qnv")) return std::nullopt;
      return name.substr(0, name.size() - 4);
    };
    maker.make = [&version](const std::string& from, const std::string& out,
                            const std::stop_token&) -> std::optional<MakeFailure> {
      std::ofstream(out) << version << std::ifstream(from).rdbuf();
      return std::nullopt;
    };
    site.options.makers.push_back(std::move(maker));
    site.start();
  }
  const auto tag = [&](int site, const std::string& target) { return sites[site].get(target).headers.at("etag"); };
  CHECK(tag(0, "/a.stl") == tag(1, "/a.stl"));
  const Got made = sites[0].get("/a.stl.qnv");
  REQUIRE(made.status == 200);
  CHECK(made.body == "1" + source);
  const Descriptor probe(::open(sites[0].made().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (::fsetxattr(probe.get(), "user.ghostspace.test", "1", 1, 0) != 0) {
    WARN("skipped: the file system has no extended attributes");
    return;
  }
  const std::string made_tag = made.headers.at("etag");
  CHECK(made_tag.ends_with("-c\""));
  CHECK(tag(1, "/a.stl.qnv") == made_tag);
  const Got rest = sites[1].get("/a.stl.qnv", {"Range: bytes=2000-", "If-Range: " + made_tag});
  CHECK(rest.status == 206);
  CHECK(rest.body == made.body.substr(2000));
  // Another version of the encoder makes other bytes of the same length.
  version = "2";
  std::filesystem::remove_all(sites[1].made());
  CHECK(tag(1, "/a.stl.qnv") != made_tag);
  CHECK(sites[1].get("/a.stl.qnv", {"Range: bytes=2000-", "If-Range: " + made_tag}).status == 200);
}

TEST_CASE("HTTP server: states how long files stay fresh") {
  const std::pair<std::int64_t, const char*> ages[] = {
      {0, "no-cache"}, {60, "public, max-age=60"}, {31'536'000, "public, max-age=31536000, immutable"}};
  for (const auto& [age, text] : ages) {
    ServedSite site;
    site.options.max_age = age;
    site.write("a.qnv", "1");
    site.start();
    CHECK(site.get("/a.qnv").headers.at("cache-control") == text);
    CHECK(site.get("/health").headers.at("cache-control") == "no-cache");
  }
}

TEST_CASE("HTTP server: answers other requests while slow files are made") {
  ServedSite site;
  for (const char* name : {"slow1", "slow2", "slow3", "quick1", "quick2"}) site.write(name, name);
  site.options.made_folder = site.made();
  std::mutex mutex;
  std::condition_variable changed;
  bool open = false;
  std::atomic<int> slow{0};
  Maker maker;
  maker.name = "thumbnail";
  maker.extension = ".png";
  maker.wait = std::chrono::seconds(20);
  maker.source_of = [](const std::string& name, const std::string& query) -> std::optional<std::string> {
    if (query != "thumbnail") return std::nullopt;
    return name;
  };
  maker.make = [&](const std::string& source, const std::string& out,
                   const std::stop_token&) -> std::optional<MakeFailure> {
    if (source.find("slow") != std::string::npos) {
      ++slow;
      std::unique_lock lock(mutex);
      changed.wait_for(lock, std::chrono::seconds(15), [&] { return open; });
    }
    std::ofstream(out) << "picture";
    return std::nullopt;
  };
  site.options.makers.push_back(maker);
  site.start();
  std::vector<std::thread> clients;
  for (const char* name : {"/slow1?thumbnail", "/slow2?thumbnail", "/slow3?thumbnail"})
    clients.emplace_back([&site, name] { (void)site.get(name); });
  while (slow == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto begin = std::chrono::steady_clock::now();
  CHECK(site.get("/quick1?thumbnail").body == "picture");
  CHECK(site.get("/quick2?thumbnail").body == "picture");
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(8));
  {
    const std::lock_guard lock(mutex);
    CHECK_FALSE(open);
    open = true;
  }
  changed.notify_all();
  for (std::thread& client : clients) client.join();
  CHECK(slow == 3);
  CHECK(site.get("/slow3?thumbnail").body == "picture");
}

TEST_CASE("HTTP server: offers a coarse version until the complete file is made") {
  ServedSite site;
  site.write("run.h5", "values");
  site.options.made_folder = site.made();
  std::mutex mutex;
  std::condition_variable changed;
  bool open = false;
  std::atomic<int> complete{0};
  const auto maker_of = [](const std::string& name, const std::string& extension) {
    Maker maker;
    maker.name = name;
    maker.extension = ".qnv";
    maker.for_missing = true;
    maker.wait = std::chrono::seconds(20);
    maker.source_of = [extension](const std::string& asked, const std::string&) -> std::optional<std::string> {
      if (!asked.ends_with(extension)) return std::nullopt;
      return asked.substr(0, asked.size() - extension.size());
    };
    return maker;
  };
  Maker whole = maker_of("encode", ".h5.qnv"), coarse = maker_of("coarse", ".coarse.qnv");
  whole.source_of = [](const std::string& asked, const std::string&) -> std::optional<std::string> {
    if (asked != "run.h5.qnv") return std::nullopt;
    return "run.h5";
  };
  whole.make = [&](const std::string&, const std::string& out, const std::stop_token&) -> std::optional<MakeFailure> {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, std::chrono::seconds(15), [&] { return open; });
    std::ofstream(out) << "all values";
    ++complete;
    return std::nullopt;
  };
  coarse.coarse_of = "encode";
  coarse.make = [](const std::string&, const std::string& out, const std::stop_token&) -> std::optional<MakeFailure> {
    std::ofstream(out) << "few values";
    return std::nullopt;
  };
  site.options.makers = {whole, coarse};
  site.start();
  CHECK(site.get("/other.h5.coarse.qnv").status == 404);
  CHECK(site.get("/run.h5.coarse.qnv").body == "few values");
  CHECK(complete == 0);
  {
    const std::lock_guard lock(mutex);
    open = true;
  }
  changed.notify_all();
  CHECK(site.get("/run.h5.qnv").body == "all values");  // the first request has begun it
  CHECK(complete == 1);
  CHECK(site.get("/run.h5.coarse.qnv").status == 404);
}
