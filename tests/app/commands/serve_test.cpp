#include "app/serve/archive.h"
#include "app/serve/archive_index.h"
#include "app/serve/cell_archive.h"
#include "app/serve/child_program.h"
#include "qnv/container/container.h"

#include "tests/app/formats_helpers.h"
#include "tests/app/program.h"
#include "tests/app/scratch_folder.h"
#include "tests/net/http_client.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

using namespace gs;
using namespace gs::app;
using net::test::fetch;
using net::test::Got;
using test::string_of;

namespace {

const std::string kWorld =
    "#VRML V2.0 utf8\nWorldInfo { title \"ball\" }\n"
    "Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } "
    "} geometry Sphere { radius 2 } }\n";

std::unique_ptr<Archive> started(const ArchiveOptions& options) {
  auto archive = Archive::start(options);
  if (const auto* problem = std::get_if<std::string>(&archive)) FAIL(*problem);
  return std::move(std::get<std::unique_ptr<Archive>>(archive));
}

ArchiveOptions options_for(const ScratchFolder& folder, const ScratchFolder& cache) {
  ArchiveOptions options;
  options.folder = folder.path("");
  options.cache = cache.path("");
  options.http_port = 0;
  options.log = cache.path("log");
  options.program = program();
  return options;
}

// Requests a file until it is made.
Got fetch_made(std::uint16_t port, const std::string& target) {
  for (;;) {
    Got got = fetch(port, target);
    if (got.status != 503) return got;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

}  // namespace

TEST_CASE("serves the types of its table and of the web") {
  CHECK(served_type_of("a.WRL").mime == "model/vrml");
  CHECK(served_type_of("a.wrl").compress);
  CHECK_FALSE(served_type_of("a.wrz").compress);
  CHECK(served_type_of("a.qnv").mime == "model/x-qnv");
  CHECK_FALSE(served_type_of("a.qnv").compress);
  CHECK(served_type_of("a.gltf").mime == "model/gltf+json");
  CHECK(served_type_of("a.wrl.gz").mime == "application/gzip");
  CHECK(served_type_of("a").mime == "application/octet-stream");
  CHECK(served_type_of("a.").mime == "application/octet-stream");
  CHECK(served_type_of(".wrl").mime == "application/octet-stream");
  CHECK(can_be_encoded("a.stl"));
  CHECK(can_be_encoded("a.nrrd"));
  CHECK_FALSE(can_be_encoded("a.qnv"));
  CHECK_FALSE(can_be_encoded("a.txt"));
  CHECK_FALSE(can_be_encoded(""));
}

TEST_CASE("shows file names in an index as text") {
  net::FolderListing listing;
  listing.path = "/<b>/";
  listing.entries = {{"sub", true, 0, 0},
                     {"\"><script>x", false, 1500, 784111777},
                     {"javascript:a.wrl", false, 5, 0},
                     {"\xff", false, 0, 0}};
  const std::string html = archive_index(listing, {}, true).body;
  CHECK(html.find("<b>") == std::string::npos);
  CHECK(html.find("<script>") == std::string::npos);
  CHECK(html.find("href=\"javascript") == std::string::npos);
  CHECK(html.find("./javascript%3Aa.wrl?thumbnail") != std::string::npos);
  CHECK(html.find("1.5 kB") != std::string::npos);
  CHECK(html.find(">1994-11-06 08:49 UTC<") != std::string::npos);
  CHECK(html.find("href=\"../\"") != std::string::npos);
  const auto json = nlohmann::json::parse(archive_index(listing, {true, {}, {}}, true).body);
  REQUIRE(json["entries"].size() == 4);
  CHECK(json["path"] == "/<b>/");
  CHECK(json["entries"][2]["qnv"] == "./javascript%3Aa.wrl.qnv");
  CHECK(json["entries"][2]["type"] == "model/vrml");
  CHECK(archive_index(listing, {}, false).body.find("thumbnail") == std::string::npos);
}

TEST_CASE("searches and sorts an index on the server, without scripts") {
  net::FolderListing listing;
  listing.path = "/a b/c/";
  listing.entries = {
      {"sub", true, 0, 0}, {"Tower.wrl", false, 10, 3}, {"gate.wrl", false, 30, 1}, {"x.stl", false, 20, 2}};
  const auto order = [&](const std::string& query) {
    const std::string page = archive_index(listing, {false, query, {}}, true).body;
    CHECK(page.find("<script") == std::string::npos);
    std::map<std::size_t, std::string> places;
    for (const net::FolderEntry& entry : listing.entries)
      if (const std::size_t at = page.find(">" + entry.name); at != std::string::npos) places[at] = entry.name;
    std::string names;
    for (const auto& [at, name] : places) names += name + " ";
    return names;
  };
  const std::pair<const char*, const char*> orders[] = {
      {"", "sub Tower.wrl gate.wrl x.stl "},
      {"sort=size", "sub Tower.wrl x.stl gate.wrl "},
      {"sort=-size", "sub gate.wrl x.stl Tower.wrl "},
      {"sort=date&search=", "sub gate.wrl x.stl Tower.wrl "},
      {"search=TOWER", "Tower.wrl "},
      {"search=%2ewrl&sort=-name", "gate.wrl Tower.wrl "},
      {"search=nothing", ""},
  };
  for (const auto& [query, names] : orders) CHECK(order(query) == names);
  const std::string page = archive_index(listing, {false, "search=%22%3E%3Cb%3E&sort=%22%3E%3Cb%3E", {}}, true).body;
  CHECK(page.find("\"><b>") == std::string::npos);
  CHECK(page.find("<a href=\"../\">a b</a> / <a href=\"./\">c</a>") != std::string::npos);
  // A click on a mesh opens its stream. A click on a world opens the world itself.
  CHECK(page.find("Tower.wrl.gslink") == std::string::npos);
  const std::string whole = archive_index(listing, {}, true).body;
  CHECK(whole.find("href=\"./Tower.wrl.gslink\"") != std::string::npos);
  CHECK(whole.find("href=\"./x.stl.qnv.gslink\"") != std::string::npos);
  CHECK(archive_index(listing, {}, false).body.find("href=\"./x.stl.gslink\"") != std::string::npos);
}

TEST_CASE("links the scene under the server name that the client uses") {
  const net::FolderRequest request{false, {}, "http://example.org:8080/a%20b/"};
  const auto text = [&](const std::string& name, bool made = true) {
    const auto page = scene_link_page(name, request, made);
    return page ? page->mime + "|" + page->body : std::string();
  };
  CHECK(text("my world.wrl.gslink") ==
        "application/x-ghostspace-link|[GhostSpace link]\nURL=http://example.org:8080/a%20b/my%20world.wrl\n");
  CHECK(text("x.stl.qnv.gslink").find("x.stl.qnv\n") != std::string::npos);
  CHECK(text("x.txt.gslink").empty());
  CHECK(text("x.wrl").empty());
  CHECK_FALSE(scene_link_page("x.wrl.gslink", {}, true));
  CHECK(served_type_of("a.gslink").mime == "application/x-ghostspace-link");
}

TEST_CASE("limits and stops a child program, and reports its failure") {
  std::stop_source stop;
  CHECK_FALSE(run_child("/bin/sh", {"-c", "exit 0"}, {}, stop.get_token()));
  CHECK(run_child("/bin/sh", {"-c", "echo first >&2; echo last >&2; exit 1"}, {}, stop.get_token())->message == "last");
  CHECK(run_child("/nowhere", {}, {}, stop.get_token()).has_value());
  ChildLimits limits;
  limits.time = std::chrono::seconds(0);
  CHECK(run_child("/bin/sh", {"-c", "sleep 1000"}, limits, stop.get_token())->message == "exceeded the time limit");
  stop.request_stop();
  CHECK(run_child("/bin/sh", {"-c", "sleep 1000"}, {}, stop.get_token())->message == "was stopped");
}

TEST_CASE("serve: lists a folder with generated thumbnails and streams") {
  const ScratchFolder folder, cache;
  folder.write("ball.wrl", kWorld);
  folder.write("bad.stl", "this is no mesh");
  const auto archive = started(options_for(folder, cache));
  const std::uint16_t port = *archive->http_port();
  const auto json = nlohmann::json::parse(fetch(port, "/?json").body);
  REQUIRE(json["entries"].size() == 2);
  CHECK(json["entries"][1]["qnv"] == "./ball.wrl.qnv");
  const Got picture = fetch_made(port, "/ball.wrl?thumbnail");
  CHECK(picture.status == 200);
  INFO(picture.body.substr(0, 200));
  CHECK(picture.body.starts_with("\x89PNG"));
  CHECK(picture.headers.at("content-type") == "image/png");
  const Got stream = fetch_made(port, "/ball.wrl.qnv");
  CHECK(stream.status == 200);
  REQUIRE(qnv::is_stream(std::as_bytes(std::span(stream.body))));
  CHECK(stream.headers.at("content-type") == "model/x-qnv");
  const Got range = fetch(port, "/ball.wrl.qnv", {"Range: bytes=1-7", "If-Range: " + stream.headers.at("etag")});
  CHECK(range.status == 206);
  CHECK(range.body == stream.body.substr(1, 7));
  const Got bad = fetch_made(port, "/bad.stl.qnv");
  CHECK(bad.status == 422);
  CHECK(bad.body.find("bad.stl") != std::string::npos);
  CHECK(bad.body.find(folder.path("")) == std::string::npos);
  // A link uses the server name of the client.
  const std::string host = "localhost:" + std::to_string(port);
  const Got link = fetch(port, "/ball.wrl.gslink", {"Host: " + host});
  CHECK(link.status == 200);
  CHECK(link.headers.at("content-type") == "application/x-ghostspace-link");
  CHECK(link.body == "[GhostSpace link]\nURL=http://" + host + "/ball.wrl\n");
  CHECK(fetch(port, "/nothing.gslink").status == 404);
  CHECK(fetch(port, "/?search=bad&sort=size").body.find("ball.wrl") == std::string::npos);
  // Pages of other sites have no access, and requests under other host names have none.
  CHECK(stream.headers.count("access-control-allow-origin") == 0);
  CHECK(fetch(port, "/ball.wrl", {"Host: evil.example"}).status == 421);
  archive->stop(std::chrono::seconds(1));
  CHECK(cache.read("log").find("\"GET /ball.wrl.qnv HTTP/1.1\" 206 7 ") != std::string::npos);
}

TEST_CASE("serve: keeps files outside the folder and the network out of generated files") {
  const ScratchFolder folder, cache, elsewhere;
  std::string voxels(std::size_t{24} * 24 * 24, '\0');
  for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = static_cast<char>((i % 24) * 10);
  const std::string secret = elsewhere.write("secret.raw", voxels);
  const auto header = [](const std::string& file) {
    return "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 24 24\nencoding: raw\ndata file: " + file + "\n";
  };
  folder.write("beside.nhdr", header("beside.raw"));
  folder.write("beside.raw", voxels);
  folder.write("there.nhdr", header(secret));
  folder.write("missing.nhdr", header(elsewhere.path("missing.raw")));
  folder.write("up.nhdr", header("../" + std::filesystem::path(elsewhere.path("x")).parent_path().filename().string() +
                                 "/secret.raw"));
  folder.write("passwd.nhdr", header("/etc/passwd"));
  ArchiveOptions options = options_for(folder, cache);
  std::atomic<int> reports{0};
  options.report = [&reports](const std::string& message) { reports += message.find("failed: ") != std::string::npos; };
  const auto archive = started(options);
  const std::uint16_t port = *archive->http_port();
  CHECK(fetch_made(port, "/beside.nhdr.qnv").status == 200);
  const Got there = fetch_made(port, "/there.nhdr.qnv"), missing = fetch_made(port, "/missing.nhdr.qnv");
  CHECK(there.status == 422);
  CHECK(missing.status == 422);
  CHECK(fetch_made(port, "/up.nhdr.qnv").status == 422);
  CHECK(fetch_made(port, "/passwd.nhdr.qnv").status == 422);
  for (const Got& got : {there, missing, fetch_made(port, "/passwd.nhdr.qnv"), fetch_made(port, "/up.nhdr.qnv")})
    for (const std::string& hidden : {elsewhere.path(""), folder.path(""), cache.path(""), std::string("/etc")})
      CHECK(got.body.find(hidden) == std::string::npos);
  CHECK(reports == 4);
  folder.write("asks.wrl", kWorld + "Inline { url \"http://127.0.0.1:" + std::to_string(port) + "/asked.wrl\" }\n");
  CHECK(fetch_made(port, "/asks.wrl?thumbnail").status == 200);
  archive->stop(std::chrono::seconds(1));
  CHECK(cache.read("log").find("asked.wrl") == std::string::npos);
}

TEST_CASE("serve: reads the whole served folder for a generated file") {
  const ScratchFolder folder, cache, elsewhere;
  folder.write("ball.wrl", kWorld);
  folder.write("deep/up.wrl", "#VRML V2.0 utf8\nInline { url \"../ball.wrl\" }\n");
  folder.write("deep/none.wrl", "#VRML V2.0 utf8\nInline { url \"../none.wrl\" }\n");
  elsewhere.write("ball.wrl", kWorld);
  std::filesystem::create_symlink(elsewhere.path("ball.wrl"), folder.path("link.wrl"));
  folder.write("deep/out.wrl", "#VRML V2.0 utf8\nInline { url \"../link.wrl\" }\n");
  const auto archive = started(options_for(folder, cache));
  const std::uint16_t port = *archive->http_port();
  const Got up = fetch_made(port, "/deep/up.wrl.qnv");
  INFO(up.body.substr(0, 200));
  CHECK(up.status == 200);
  // A world without a surface cannot be encoded.
  CHECK(fetch_made(port, "/deep/none.wrl.qnv").status == 422);
  CHECK(fetch_made(port, "/deep/out.wrl.qnv").status == 422);
}

TEST_CASE("serve: generates a file again after the disk was full") {
  const ScratchFolder folder, cache;
  folder.write("ball.wrl", kWorld);
  ArchiveOptions options = options_for(folder, cache);
  // Simulates the program on a full disk.
  const std::string full = cache.write("full", "");
  options.program = cache.write("program", "#!/bin/sh\n[ -e '" + full + "' ] && echo 'cannot write " + full +
                                               "' >&2 && exit 3\nexec '" + program() + "' \"$@\"\n");
  std::filesystem::permissions(options.program, std::filesystem::perms::owner_all);
  const auto archive = started(options);
  const std::uint16_t port = *archive->http_port();
  const Got none = fetch(port, "/ball.wrl.qnv");
  CHECK(none.status == 503);
  CHECK(none.headers.count("retry-after") == 1);
  CHECK(none.body.find('/') == std::string::npos);
  std::filesystem::remove(full);
  CHECK(fetch_made(port, "/ball.wrl.qnv").status == 200);
  // Neither attempt leaves a file.
  for (const auto& entry : std::filesystem::directory_iterator(cache.path("")))
    CHECK_FALSE(entry.path().filename().string().starts_with("making"));
}

TEST_CASE("serve: accepts options for host names, pages and proxies") {
  const ScratchFolder folder, cache;
  folder.write("a.txt", "a");
  ArchiveOptions options = options_for(folder, cache);
  options.host_names = {"gallery.lan"};
  options.origins = {"https://gallery.example"};
  const auto archive = started(options);
  const Got got = fetch(*archive->http_port(), "/a.txt", {"Host: gallery.lan", "Origin: https://gallery.example"});
  CHECK(got.status == 200);
  CHECK(got.headers.at("access-control-allow-origin") == "https://gallery.example");
  const ScratchFolder other;
  options = options_for(folder, other);
  options.bind = "*";
  const auto open = started(options);
  CHECK(fetch(*open->http_port(), "/a.txt", {"Host: any.example"}).headers.at("access-control-allow-origin") == "*");
}

TEST_CASE("serve: reports files that cannot be served") {
  const ScratchFolder folder, cache;
  ArchiveOptions options = options_for(folder, cache);
  options.folder = folder.path("nothing");
  CHECK(std::holds_alternative<std::string>(Archive::start(options)));
  options = options_for(folder, cache);
  options.cache = folder.path("cache");
  CHECK(std::get<std::string>(Archive::start(options)).find("is inside the served folder") != std::string::npos);
  options = options_for(folder, cache);
  options.bind = "elsewhere";
  CHECK(std::holds_alternative<std::string>(Archive::start(options)));
}

TEST_CASE("serve: sends streams as cells, as octrees and as records") {
  const ScratchFolder folder, cache;
  folder.write("ball.wrl", kWorld);
  ArchiveOptions options = options_for(folder, cache);
  options.cells_port = 0;
  const auto archive = started(options);
  folder.write("packed.qnv", fetch_made(*archive->http_port(), "/ball.wrl.qnv").body);
  std::stop_source stop;
  REQUIRE_FALSE(run_child(
      program(), {"encode", "--records", "--vectors", "20000", folder.path("ball.wrl"), folder.path("records.qnv")}, {},
      stop.get_token()));
  auto opened = CellArchive::of_folder(folder.path(""));
  const auto library = std::get<std::shared_ptr<CellArchive>>(opened);
  for (const std::string name : {"packed.qnv", "records.qnv"}) {
    auto found = library->open(name);
    if (auto* problem = std::get_if<std::string>(&found)) FAIL(*problem);
    net::CellSource& source = *std::get<std::shared_ptr<net::CellSource>>(found);
    CHECK(std::get<std::shared_ptr<net::CellSource>>(library->open("/" + name)).get() == &source);
    REQUIRE(source.streams() == 1);
    CHECK(source.records(0) == (name == "records.qnv"));
    // Base and chunks together equal the file up to its directory.
    std::string all = string_of(source.base());
    for (std::uint32_t i = 0; i < source.chunks(0); ++i) {
      const auto chunk = source.chunk(0, i);
      REQUIRE(chunk);
      CHECK(chunk->head.size() <= net::kMaxChunkHead);
      CHECK(source.box(0, i).has_value());
      all += string_of(chunk->head) + string_of(chunk->body);
    }
    const std::string file = folder.read(name);
    CHECK(file.starts_with(all));
    std::size_t header_bytes = 0;
    bool need_more = false;
    const auto header =
        std::get<qnv::StreamHeader>(qnv::decode_header(std::as_bytes(std::span(file)), header_bytes, need_more));
    CHECK(all.size() == header.directory);
    CHECK_FALSE(source.chunk(0, source.chunks(0)));
  }
  for (const char* bad : {"", "..", "../x", "ball.wrl", "nothing.qnv", "/"})
    CHECK(std::holds_alternative<std::string>(library->open(bad)));
  // A client receives the stream over UDP.
  auto client = net::CellClientDriver::start({}, "127.0.0.1", *archive->cells_port(), {});
  auto& driver = *std::get<std::unique_ptr<net::CellClientDriver>>(client);
  net::CellWish wish;
  wish.path = "packed.qnv";
  driver.want(0, wish);
  bool base = false, ended = false;
  while (!ended) {
    for (const net::CellEvent& event : driver.poll(1 << 20)) {
      if (event.kind == net::CellEvent::Kind::base)
        base = folder.read("packed.qnv").starts_with(string_of(event.bytes));
      REQUIRE(event.kind != net::CellEvent::Kind::failed);
      REQUIRE(event.kind != net::CellEvent::Kind::refused);
      ended = ended || event.kind == net::CellEvent::Kind::ended;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  CHECK(base);
  CHECK(fetch(*archive->http_port(), "/metrics").body.find("ghostspace_cells_sessions_total 1\n") != std::string::npos);
}
