#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/noncopyable.h"
#include "tests/net/http_client.h"
#include "tests/net/load_helpers.h"
#include "tests/net/served_site.h"

extern char** environ;

/// The loader with a real server: nginx on loopback, if installed.
namespace {

using namespace gs::net;
using namespace gs::net::test;

bool answers(unsigned port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool connected = ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(socket);
  return connected;
}

class Nginx : gs::NonCopyable {
 public:
  Nginx() {
    for (const char* path : {"/usr/sbin/nginx", "/usr/local/sbin/nginx", "/usr/bin/nginx", "/usr/local/bin/nginx"})
      if (::access(path, X_OK) == 0) program_ = path;
    if (program_.empty()) return;
    std::filesystem::create_directories(folder / "www");
    has_tls_ = std::system(("openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj "
                            "/CN=localhost -addext subjectAltName=IP:127.0.0.1 -keyout " +
                            (folder / "key.pem") + " -out " + (folder / "cert.pem") + " >/dev/null 2>&1")
                               .c_str()) == 0;
    // Another process may take the port before nginx listens.
    for (int attempt = 0; attempt < 5 && !running_; ++attempt) start();
  }
  ~Nginx() { stop(); }

  /// Returns false with a message if nginx is missing.
  [[nodiscard]] bool ready() const {
    if (!running_) WARN("skipped: nginx is not installed or does not start");
    return running_;
  }
  [[nodiscard]] bool has_tls() const { return has_tls_; }
  [[nodiscard]] std::string url(const std::string& name) const {
    return "http://127.0.0.1:" + std::to_string(port_) + "/" + name;
  }
  [[nodiscard]] std::string tls_url(const std::string& name) const {
    return "https://127.0.0.1:" + std::to_string(tls_port_) + "/" + name;
  }
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(folder / "www" + "/" + name, std::ios::binary) << text;
  }
  /// Returns lines of the access log: status, body bytes, requests on the connection, protocol, URI, Range.
  [[nodiscard]] std::vector<std::string> log() {
    stop();
    std::ifstream file(folder / "access.log");
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }

  TemporaryFolder folder;

 private:
  void stop() {
    if (!running_) return;
    running_ = false;
    ::kill(process_, SIGQUIT);
    // The loader closes idle connections, so nginx ends.
    int status = 0;
    ::waitpid(process_, &status, 0);
  }

  void start() {
    port_ = free_port();
    tls_port_ = free_port();
    const std::string at = folder.path() + "/";
    std::ostringstream conf;
    conf << "daemon off; master_process off; worker_processes 1; pid " << at << "pid; error_log " << at
         << "error.log;\nevents { worker_connections 256; }\nhttp {\n  types { model/vrml wrl; }\n"
         << "  log_format short '$status $body_bytes_sent $connection_requests $server_protocol $uri $http_range';\n"
         << "  access_log " << at << "access.log short;\n  gzip on; gzip_types model/vrml; gzip_min_length 100;\n";
    for (const char* kind : {"client_body", "proxy", "fastcgi", "uwsgi", "scgi"})
      conf << "  " << kind << "_temp_path " << at << "temp;\n";
    conf << "  server { listen 127.0.0.1:" << port_ << ";";
    if (has_tls_)
      conf << " listen 127.0.0.1:" << tls_port_ << " ssl http2; ssl_certificate " << at
           << "cert.pem; ssl_certificate_key " << at << "key.pem;";
    conf << " root " << at << "www; location /fresh/ { alias " << at
         << "www/; add_header Cache-Control max-age=60; } location /moved/ { return 301 /new/$uri; } "
         << "location /slow/ { alias " << at << "www/; limit_rate 200k; } }\n}\n";
    std::ofstream(folder / "nginx.conf") << conf.str();
    const std::string file = folder / "nginx.conf";
    const char* const arguments[] = {program_.c_str(), "-e", "stderr", "-p", at.c_str(), "-c", file.c_str(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    const int failed =
        ::posix_spawn(&process_, program_.c_str(), &actions, nullptr, const_cast<char* const*>(arguments), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) return;
    for (int i = 0; i < 2000; ++i) {
      int status = 0;
      if (::waitpid(process_, &status, WNOHANG) == process_) return;
      if (answers(port_)) {
        running_ = true;
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }

  std::string program_;
  pid_t process_ = -1;
  unsigned port_ = 0, tls_port_ = 0;
  bool running_ = false, has_tls_ = false;
};

LoaderOptions options_of(const std::string& cache_folder = {}) {
  LoaderOptions options;
  options.proxy_from_environment = false;
  options.cache_folder = cache_folder;
  options.retry_delay = Milliseconds(5);
  return options;
}

std::size_t count(const std::vector<std::string>& lines, const std::string& start) {
  return static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(), [&](const std::string& line) { return line.starts_with(start); }));
}

TEST_CASE("nginx: loads whole, compressed, ranged, redirected and missing files") {
  Nginx nginx;
  if (!nginx.ready()) return;
  const std::string text = pattern(1'000'000);
  nginx.put("a.bin", text);
  nginx.put("a.wrl", text);
  auto loader = Loader::create(options_of());

  const Outcome plain = load(*loader, nginx.url("a.bin"));
  CHECK(plain.events == "Hd.");
  CHECK((plain.text() == text));
  CHECK(plain.head.total == text.size());
  CHECK(plain.head.accepts_ranges);
  CHECK_FALSE(plain.head.validator.strong().empty());

  const Outcome zipped = load(*loader, nginx.url("a.wrl"));
  CHECK((zipped.text() == text));
  CHECK(zipped.head.content_type == "model/vrml");
  CHECK_FALSE(zipped.head.total);

  const Outcome parts =
      load(*loader, ranges_of(nginx.url("a.wrl"), {{0, 100}, {500'000, 600'000}, {999'990, 2'000'000}}));
  CHECK(parts.head.total == text.size());
  CHECK((parts.pieces == std::map<std::uint64_t, std::string>{{0, text.substr(0, 100)},
                                                              {500'000, text.substr(500'000, 100'000)},
                                                              {999'990, text.substr(999'990)}}));
  const Outcome moved = load(*loader, nginx.url("moved/x"));
  CHECK(moved.error->kind == LoadErrorKind::not_found);
  CHECK(moved.error->message == "cannot load " + nginx.url("new//moved/x") + " (redirected from " +
                                    nginx.url("moved/x") + "): the server answered 404 Not Found; expected 200 OK");
  CHECK(load(*loader, ranges_of(nginx.url("a.bin"), {{1'000'000, 1'000'001}})).error->kind ==
        LoadErrorKind::bad_request);
  loader.reset();
  const auto log = nginx.log();
  REQUIRE(log.size() >= 5);
  CHECK(log[0].starts_with("200 1000000 1 HTTP/1.1 /a.bin"));
  CHECK(log[1].starts_with("200 "));
  CHECK(std::stoul(log[1].substr(4)) < 800'000);           // compressed in transit
  CHECK(log[1].find(" 2 HTTP/1.1") != std::string::npos);  // the same connection
  CHECK(count(log, "206 100000 ") == 1);
}

TEST_CASE("nginx: caches, confirms by ETag, detects changes, and requests only missing ranges") {
  Nginx nginx;
  if (!nginx.ready()) return;
  const TemporaryFolder cache;
  const std::string text = pattern(600'000), other = pattern(500'000, 1);
  nginx.put("a.bin", text);
  nginx.put("a.wrl", text);
  auto loader = Loader::create(options_of(cache / "cache"));
  load(*loader, nginx.url("a.bin"));
  Outcome again = load(*loader, nginx.url("a.bin"));
  CHECK(again.head.from_cache);
  CHECK((again.text() == text));
  load(*loader, nginx.url("a.wrl"));
  again = load(*loader, nginx.url("a.wrl"));  // compressed: a weak ETag
  CHECK(again.head.from_cache);
  CHECK((again.text() == text));

  load(*loader, ranges_of(nginx.url("fresh/a.bin"), {{0, 1000}, {300'000, 301'000}}));
  loader = Loader::create(options_of(cache / "cache"));
  const Outcome parts = load(*loader, ranges_of(nginx.url("fresh/a.bin"), {{0, 1000}, {300'000, 310'000}}));
  CHECK((parts.pieces.at(300'000) == text.substr(300'000, 10'000)));
  CHECK(load(*loader, ranges_of(nginx.url("fresh/a.bin"), {{300'500, 309'000}})).head.from_cache);

  nginx.put("a.bin", other);
  const Outcome changed = load(*loader, nginx.url("a.bin"));
  CHECK_FALSE(changed.head.from_cache);
  CHECK((changed.text() == other));
  loader.reset();
  const auto log = nginx.log();
  CHECK(count(log, "304 0 ") == 2);
  CHECK(count(log, "206 1000 ") == 2);
  CHECK(count(log, "206 9000 ") == 1);
  CHECK(log.size() == 8);
}

TEST_CASE("nginx: loads many files at once, and cancels half-way") {
  Nginx nginx;
  if (!nginx.ready()) return;
  const std::string text = pattern(300'000);
  nginx.put("a.bin", text);
  std::atomic<int> woken{0};
  LoaderOptions options = options_of();
  options.wake = [&woken] { ++woken; };
  auto loader = Loader::create(options);
  std::vector<RequestId> ids, cancelled;
  for (int i = 0; i < 60; ++i) {
    Request request;
    request.url = nginx.url("a.bin?" + std::to_string(i));
    request.priority = i % 3;
    request.viewport = static_cast<std::uint32_t>(i % 2);
    ids.push_back(loader->request(request));
    request.url = nginx.url("slow/a.bin");
    if (i % 6 == 0) cancelled.push_back(loader->request(request));
  }
  for (const RequestId id : cancelled) loader->cancel(id);
  for (std::size_t i = 0; i < ids.size(); i += 4) loader->set_priority(ids[i], 9);
  auto outcomes = wait_for(*loader, ids, 200'000);
  for (const RequestId id : ids) CHECK((outcomes[id].text() == text));
  for (const RequestId id : cancelled) CHECK(outcomes[id].events.empty());
  CHECK(woken > 0);
  CHECK(loader->queued_bytes() == 0);
  loader.reset();
}

TEST_CASE("nginx: loads several ranges on one HTTP/2 connection over TLS, and rejects unknown certificates") {
  Nginx nginx;
  if (!nginx.ready()) return;
  if (!nginx.has_tls()) {
    WARN("skipped: openssl is not installed");
    return;
  }
  const std::string text = pattern(1'000'000);
  nginx.put("a.bin", text);
  LoaderOptions options = options_of();
  {
    const auto loader = Loader::create(options);
    const Outcome got = load(*loader, nginx.tls_url("a.bin"));
    CHECK(got.events == "!");
    CHECK(got.error->kind == LoadErrorKind::insecure);
    CHECK(got.error->message.starts_with("cannot load " + nginx.tls_url("a.bin") +
                                         ": the certificate of the server is not valid ("));
  }
  options.ca_file = nginx.folder / "cert.pem";
  auto loader = Loader::create(options);
  std::vector<ByteRange> ranges;
  for (std::uint64_t i = 0; i < 10; ++i) ranges.push_back({i * 100'000, i * 100'000 + 5000});
  const Outcome got = load(*loader, ranges_of(nginx.tls_url("a.bin"), ranges));
  CHECK(got.done);
  CHECK((got.pieces.at(900'000) == text.substr(900'000, 5000)));
  loader.reset();
  const auto log = nginx.log();
  CHECK(count(log, "206 5000 ") == 10);
  // The last request is the tenth on its connection, so there was only one connection.
  CHECK(count(log, "206 5000 10 HTTP/2.0") == 1);
}

TEST_CASE("loads from a file and a server at once, also with an unusable cache folder") {
  Nginx nginx;
  if (!nginx.ready()) return;
  const std::string text = pattern(2'000'000);
  nginx.put("a.bin", text);
  const auto loader = Loader::create(options_of("/dev/null/cache"));
  Request remote, local, data;
  remote.url = nginx.url("a.bin");
  local.url = url_of_path(nginx.folder / "www/a.bin").text();
  data.url = "data:,hello";
  const RequestId first = loader->request(remote), second = loader->request(local), third = loader->request(data);
  auto outcomes = wait_for(*loader, {first, second, third}, 100'000);
  CHECK((outcomes[first].text() == text));
  CHECK((outcomes[second].text() == text));
  CHECK(outcomes[third].text() == "hello");
}

TEST_CASE("keeps connections for the next loader, and none with a bandwidth limit") {
  ServedSite site;
  site.write("a.wrl", "#VRML V2.0 utf8\n");
  site.start();
  const auto load_alone = [&](std::uint64_t rate) {
    LoaderOptions options;
    options.bytes_per_second = rate;
    const auto loader = Loader::create(std::move(options));
    CHECK(load(*loader, "http://127.0.0.1:" + std::to_string(site.port) + "/a.wrl").text() == "#VRML V2.0 utf8\n");
  };
  for (int i = 0; i < 4; ++i) load_alone(0);
  CHECK(site.server->statistics().accepted == 1);
  // A connection of a limited loader has a small receive buffer.
  site.start();
  for (const std::uint64_t rate : {1'000'000, 0, 0}) load_alone(rate);
  CHECK(site.server->statistics().accepted == 2);
  load_alone(1'000'000);
  CHECK(site.server->statistics().accepted == 3);
  // If the server has closed its idle connections, the next loader opens a new one.
  const std::uint16_t port = site.port;
  site.server.reset();
  site.options.port = port;
  site.start();
  load_alone(0);
}

}  // namespace
