#include "net/serve/http_server.h"

#include "tests/net/served_site.h"

#include <zlib.h>

#include <filesystem>

#include <sys/stat.h>

using namespace gs::net;
using namespace gs::net::test;
namespace fs = std::filesystem;

namespace {

std::string gunzipped(const std::string& bytes) {
  z_stream stream{};
  REQUIRE(inflateInit2(&stream, 31) == Z_OK);
  std::string out(1 << 20, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  CHECK(inflate(&stream, Z_FINISH) == Z_STREAM_END);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

ServedType by_name(const std::string& name) {
  if (name.ends_with(".wrl")) return {"model/vrml", true};
  return {};
}

}  // namespace

TEST_CASE("HTTP server: sends files with their headers, and answers HEAD, OPTIONS and other methods") {
  ServedSite site;
  site.options.type_of = by_name;
  site.options.origins = {"*"};
  const std::string bytes = binary_pattern(200'000);
  site.write("a b.qnv", bytes);
  site.write("empty", "");
  site.write("deep/world.wrl", "#VRML V2.0 utf8\n");
  site.start();
  const Got got = site.get("/a%20b.qnv");
  CHECK(got.status == 200);
  CHECK(got.body == bytes);
  CHECK(got.headers.at("content-length") == "200000");
  CHECK(got.headers.at("accept-ranges") == "bytes");
  CHECK(got.headers.at("access-control-allow-origin") == "*");
  CHECK(got.headers.at("x-content-type-options") == "nosniff");
  CHECK(got.headers.at("cache-control") == "no-cache");
  CHECK(got.headers.at("etag").size() == 18);
  CHECK(got.headers.count("last-modified") == 1);
  CHECK(site.get("/deep/world.wrl").headers.at("content-type") == "model/vrml");
  const Got head = site.get("/a%20b.qnv", {}, "HEAD");
  CHECK(head.status == 200);
  CHECK(head.body.empty());
  CHECK(head.headers.at("content-length") == "200000");
  CHECK(head.headers.at("etag") == got.headers.at("etag"));
  const Got empty = site.get("/empty");
  CHECK(empty.status == 200);
  CHECK(empty.headers.at("content-length") == "0");
  const Got options =
      site.get("/a%20b.qnv", {"Origin: https://example.org", "Access-Control-Request-Method: GET"}, "OPTIONS");
  CHECK(options.status == 204);
  CHECK(options.headers.at("access-control-allow-methods") == "GET, HEAD, OPTIONS");
  CHECK(options.headers.at("access-control-allow-headers").find("If-Range") != std::string::npos);
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "TRACE", "BREW"}) {
    const Got refused = site.get("/a%20b.qnv", {}, method);
    CHECK(refused.status == 405);
    CHECK(refused.headers.at("allow") == "GET, HEAD, OPTIONS");
  }
  CHECK(site.get("/deep").status == 301);
  CHECK(site.get("/deep").headers.at("location") == "/deep/");
  CHECK(site.get("/deep/").status == 404);  // without a listing
  CHECK(site.get("/nothing").status == 404);
  CHECK(site.get("/health").body == "ok\n");
}

TEST_CASE("HTTP server: serves only regular, visible files of its folder") {
  ServedSite site;
  site.write("inside.txt", "inside");
  site.write("folder/file", "file");
  site.write("../secret", "secret");
  site.write(".hidden", "hidden");
  site.write("folder/.hidden", "hidden");
  fs::create_symlink("../secret", site.path("escape"));
  fs::create_symlink("..", site.path("up"));
  fs::create_symlink(fs::absolute(site.path("inside.txt")), site.path("absolute"));
  fs::create_symlink("inside.txt", site.path("alias"));
  fs::create_symlink("loop", site.path("loop"));
  REQUIRE(::mkfifo(site.path("pipe").c_str(), 0600) == 0);
  for (const bool beneath : {true, false}) {
    site.options.resolve_beneath = beneath;
    site.start();
    CHECK(site.get("/inside.txt").body == "inside");
    for (const char* target : {"/../secret",
                               "/%2e%2e/secret",
                               "/%2E./secret",
                               "/folder/../../secret",
                               "/folder/..%2f..%2fsecret",
                               "/..\\secret",
                               "/..%5csecret",
                               "/%5c..%5csecret",
                               "/inside.txt%00",
                               "/inside.txt%00.wrl",
                               "/%00",
                               "//etc/passwd",
                               "/folder//file",
                               "/.hidden",
                               "/%2ehidden",
                               "/folder/.hidden",
                               "/./inside.txt",
                               "/folder/.",
                               "/folder/..",
                               "/escape",
                               "/up/secret",
                               "/up/",
                               "/absolute",
                               "/loop",
                               "/pipe",
                               "/inside.txt/",
                               "/%",
                               "/%2",
                               "/%zz",
                               "/a%0d%0ab",
                               "/%ff",
                               "/folder%2ffile",
                               "/%c0%ae%c0%ae/secret",
                               "/..;/secret"}) {
      const Got got = site.get(target);
      INFO(target);
      CHECK((got.status == 404 || got.status == 400));
      CHECK(got.body.find("secret\n") == std::string::npos);
      CHECK(got.body != "secret");
      CHECK(got.body != "hidden");
    }
    CHECK(site.get("/" + std::string(5000, 'a')).status == 414);
    CHECK(site.get("/" + std::string(300, 'a')).status == 404);
    if (!beneath) CHECK(site.get("/alias").status == 404);
    RawClient raw(site.port);
    raw.send("GET ../secret HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    CHECK(raw.receive_all().find("HTTP/1.1 400") == 0);
    RawClient absolute(site.port);
    absolute.send(
        "GET http://localhost:1/inside.txt HTTP/1.1\r\nHost: "
        "localhost\r\nConnection: close\r\n\r\n");
    CHECK(absolute.receive_all().ends_with("\r\n\r\ninside"));
    site.server.reset();
  }
}

TEST_CASE("HTTP server: sends single and several ranges") {
  ServedSite site;
  const std::string bytes = binary_pattern(1000);
  site.write("a", bytes);
  site.start();
  const auto range = [&](const std::string& value) { return site.get("/a", {"Range: bytes=" + value}); };
  const auto single = [&](const std::string& value, std::size_t begin, std::size_t end) {
    const Got got = range(value);
    INFO(value);
    CHECK(got.status == 206);
    CHECK(got.body == bytes.substr(begin, end - begin));
    CHECK(got.headers.at("content-range") ==
          "bytes " + std::to_string(begin) + "-" + std::to_string(end - 1) + "/1000");
  };
  single("0-0", 0, 1);
  single("999-999", 999, 1000);
  single("999-", 999, 1000);
  single("-1", 999, 1000);
  single("-1000", 0, 1000);
  single("-1001", 0, 1000);
  single("0-999", 0, 1000);
  single("0-99999999999999999999999999", 0, 1000);
  single("100-200,201-300", 100, 301);
  single("300-400,100-350", 100, 401);
  for (const char* none : {"1000-", "1000-1001", "-0", "18446744073709551616-"}) {
    const Got got = range(none);
    INFO(none);
    CHECK(got.status == 416);
    CHECK(got.headers.at("content-range") == "bytes */1000");
  }
  for (const char* whole : {"", "-", "5-4", "a-b", "1", "0-1,x", "--1"}) {
    INFO(whole);
    CHECK(range(whole).status == 200);
  }
  CHECK(site.get("/a", {"Range: cows=0-1"}).status == 200);
  const Got some = range("0-9,500-509,-10");
  CHECK(some.status == 206);
  const std::string type = some.headers.at("content-type"), mark = "multipart/byteranges; boundary=";
  REQUIRE(type.starts_with(mark));
  const std::string line = "\r\n--" + type.substr(mark.size());
  const auto part = [&](std::size_t begin) {
    return line +
           "\r\nContent-Type: application/octet-stream\r\nContent-Range: "
           "bytes " +
           std::to_string(begin) + "-" + std::to_string(begin + 9) + "/1000\r\n\r\n" + bytes.substr(begin, 10);
  };
  CHECK(some.body == part(0) + part(500) + part(990) + line + "--\r\n");
  std::string many = "0-0";
  for (int i = 1; i < 40; ++i) many += "," + std::to_string(i * 20) + "-" + std::to_string(i * 20);
  CHECK(range(many).status == 200);
}

TEST_CASE("HTTP server: answers conditional requests by validators") {
  ServedSite site;
  const std::string bytes = binary_pattern(1000);
  site.write("a", bytes);
  site.start();
  const Got first = site.get("/a");
  const std::string tag = first.headers.at("etag"), date = first.headers.at("last-modified");
  const std::string old = "Sun, 06 Nov 1994 08:49:37 GMT";
  const auto status = [&](std::vector<std::string> headers) { return site.get("/a", headers).status; };
  CHECK(status({"If-None-Match: " + tag}) == 304);
  CHECK(status({"If-None-Match: \"x\", W/" + tag}) == 304);
  CHECK(status({"If-None-Match: *"}) == 304);
  CHECK(status({"If-None-Match: \"x\""}) == 200);
  CHECK(status({"If-None-Match: \"x\"", "If-Modified-Since: " + date}) == 200);
  CHECK(status({"If-Modified-Since: " + date}) == 304);
  CHECK(status({"If-Modified-Since: " + old}) == 200);
  CHECK(status({"If-Match: " + tag}) == 200);
  CHECK(status({"If-Match: W/" + tag}) == 412);
  CHECK(status({"If-Unmodified-Since: " + old}) == 412);
  CHECK(status({"Range: bytes=0-1", "If-Range: " + tag}) == 206);
  CHECK(status({"Range: bytes=0-1", "If-Range: W/" + tag}) == 200);
  CHECK(status({"Range: bytes=0-1", "If-Range: \"x\""}) == 200);
  CHECK(status({"Range: bytes=0-1", "If-Range: " + date}) == 206);
  CHECK(status({"Range: bytes=0-1", "If-Range: " + old}) == 200);
  CHECK(status({"Range: bytes=5000-", "If-Range: \"x\""}) == 200);
  const Got same = site.get("/a", {"If-None-Match: " + tag});
  CHECK(same.body.empty());
  CHECK(same.headers.at("etag") == tag);
  site.write("b", binary_pattern(1000));
  fs::last_write_time(site.path("b"), fs::last_write_time(site.path("a")) + std::chrono::seconds(1));
  fs::rename(site.path("b"), site.path("a"));
  CHECK(site.get("/a").headers.at("etag") != tag);
}

TEST_CASE("HTTP server: sends gzip files and compresses on the fly, but never ranges") {
  ServedSite site;
  site.options.type_of = by_name;
  site.options.made_folder = site.made();
  std::string world = "#VRML V2.0 utf8\n";
  for (int i = 0; i < 1000; ++i) world += "Shape { geometry Box { } }\n";
  site.write("a.wrl", world);
  site.write("b.wrl", world);
  site.write("b.wrl.gz", "as it lies there");
  site.write("c.wrl", "short");
  site.start();
  for (int i = 0; i < 2; ++i) {
    const Got got = site.get("/a.wrl", {"Accept-Encoding: deflate, gzip;q=0.5"});
    CHECK(got.status == 200);
    REQUIRE(got.headers.count("content-encoding") == 1);
    CHECK(got.headers.at("vary") == "Accept-Encoding");
    CHECK(got.headers.at("content-type") == "model/vrml");
    CHECK(got.body.size() < world.size() / 10);
    CHECK(gunzipped(got.body) == world);
    CHECK(got.headers.at("etag").ends_with("-gz\""));
    CHECK(site.get("/a.wrl", {"Accept-Encoding: gzip", "If-None-Match: " + got.headers.at("etag")}).status == 304);
  }
  const Got plain = site.get("/a.wrl", {"Accept-Encoding: gzip;q=0, identity"});
  CHECK(plain.body == world);
  CHECK(plain.headers.at("vary") == "Accept-Encoding");
  const Got range = site.get("/a.wrl", {"Accept-Encoding: gzip", "Range: bytes=0-4"});
  CHECK(range.status == 206);
  CHECK(range.body == "#VRML");
  CHECK(range.headers.at("etag") == plain.headers.at("etag"));
  CHECK(site.get("/b.wrl", {"Accept-Encoding: gzip"}).body == "as it lies there");
  CHECK(site.get("/b.wrl").body == world);
  fs::last_write_time(site.path("b.wrl.gz"), fs::file_time_type::clock::now() - std::chrono::hours(1));
  CHECK(gunzipped(site.get("/b.wrl", {"Accept-Encoding: gzip"}).body) == world);
  CHECK(site.get("/c.wrl", {"Accept-Encoding: gzip"}).body == "short");
}

TEST_CASE("HTTP server: lists folders, JSON and metrics") {
  ServedSite site;
  site.write("b", "12");
  site.write("sub/c", "");
  site.write(".d", "");
  site.options.list = [](const FolderListing& listing, const FolderRequest& request) {
    const bool json = request.json;
    std::string text = (json ? "json " : "html ") + listing.path;
    for (const FolderEntry& entry : listing.entries)
      text += " " + entry.name + (entry.folder ? "/" : "=" + std::to_string(entry.size));
    return FolderPage{json ? "application/json" : "text/html", text};
  };
  site.start();
  const Got page = site.get("/");
  CHECK(page.body == "html / sub/ b=2");
  CHECK(page.headers.at("content-security-policy").starts_with("default-src 'none'"));
  CHECK(site.get("/sub/").body == "html /sub/ c=0");
  CHECK(site.get("/?json").body == "json / sub/ b=2");
  CHECK(site.get("/", {"Accept: application/json"}).body == "json / sub/ b=2");
  CHECK(site.get("/", {"Accept: text/html, application/json"}).body == "html / sub/ b=2");
  CHECK(site.get("/", {"If-None-Match: " + page.headers.at("etag")}).status == 304);
  const Got metrics = site.get("/metrics");
  CHECK(metrics.headers.at("content-type") == "text/plain; version=0.0.4; charset=utf-8");
  CHECK(metrics.body.find("ghostspace_http_requests_total{status=\"200\"} 5\n") != std::string::npos);
  site.write("index.html", "<p>own</p>");
  CHECK(site.get("/").body == "<p>own</p>");
}

TEST_CASE("HTTP server: passes POST without a body to its owner, and refuses bodies") {
  ServedSite site;
  std::vector<std::string> received;
  site.options.post = [&](const PostRequest& request) {
    received.push_back(request.path + ' ' + request.query + ' ' + request.authorization);
    return request.query == "a=1" ? PostAnswer{200, "ok"} : PostAnswer{400, "expected a=1"};
  };
  site.write("x", "file");
  site.start();
  const Got got = site.get("/set?a=1", {"Authorization: Bearer secret", "Content-Length: 0"}, "POST");
  CHECK(got.status == 200);
  CHECK(got.body == "ok\n");
  CHECK(got.headers.at("cache-control") == "no-store");
  CHECK(site.get("/set?a=2", {}, "POST").body == "expected a=1\n");
  CHECK(received == std::vector<std::string>{"/set a=1 Bearer secret", "/set a=2 "});
  CHECK(site.get("/x").body == "file");
  CHECK(site.get("/set?a=1", {"Host: evil.example"}, "POST").status == 421);
  CHECK(site.get("/set?a=1", {"Content-Length: 5"}, "POST").status == 413);
  CHECK(received.size() == 2);
  // An answer that is not ready blocks no other request.
  std::atomic<bool> ready{false};
  site.options.post = [&](const PostRequest&) {
    return PostAnswer{0, {}, [&]() -> std::optional<PostAnswer> {
                        if (!ready) return std::nullopt;
                        return PostAnswer{409, "too late"};
                      }};
  };
  site.start();
  std::thread client([&] {
    const Got late = site.get("/set?a=1", {}, "POST");
    CHECK(late.status == 409);
    CHECK(late.body == "too late\n");
  });
  CHECK(site.get("/x").body == "file");
  ready = true;
  client.join();
  site.options.content_wait = std::chrono::milliseconds(20);
  ready = false;
  site.start();
  CHECK(site.get("/set?a=1", {}, "POST").status == 504);
  site.options.post = {};
  site.start();
  CHECK(site.get("/set?a=1", {}, "POST").status == 405);
}
