#include "base/noncopyable.h"
#include "tests/net/served_site.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <arpa/inet.h>
#include <spawn.h>
#include <sys/wait.h>
#include <csignal>

extern char** environ;

using namespace gs::net::test;
namespace fs = std::filesystem;

namespace {

// Returns the tested block of docs/serving.md.
std::string documented_block() {
  std::ifstream file(GHOSTSPACE_TESTS "/../docs/serving.md");
  std::stringstream all;
  all << file.rdbuf();
  const std::string text = all.str(), mark = "```nginx\n";
  const std::size_t begin = text.find(mark);
  REQUIRE(begin != std::string::npos);
  const std::size_t end = text.find("```", begin + mark.size());
  REQUIRE(end != std::string::npos);
  CHECK(text.find(mark, end) == std::string::npos);
  return text.substr(begin + mark.size(), end - begin - mark.size());
}

/// nginx with the documented block, for one folder; killed at the end.
class DocumentedNginx : gs::NonCopyable {
 public:
  explicit DocumentedNginx(const fs::path& base) {
    const std::string program = "/usr/sbin/nginx";
    if (::access(program.c_str(), X_OK) != 0) return;
    const std::string block = documented_block();
    for (int attempt = 0; attempt < 5 && !running; ++attempt) start(program, base, block);
  }
  ~DocumentedNginx() {
    if (child_ <= 0) return;
    ::kill(child_, SIGTERM);
    ::waitpid(child_, nullptr, 0);
  }

  bool running = false;
  std::uint16_t port = 0;

 private:
  void start(const std::string& program, const fs::path& base, const std::string& block) {
    port = free_port();
    const std::string at = base.string(), config = at + "/nginx.conf";
    std::ofstream(config) << "daemon off;\nmaster_process off;\nworker_processes 1;\npid " << at << "/pid;\nerror_log "
                          << at << "/errors;\nevents { worker_connections 64; }\nhttp {\n"
                          << "access_log off;\nclient_body_temp_path " << at << "/b;\nproxy_temp_path " << at
                          << "/p;\nfastcgi_temp_path " << at << "/f;\nuwsgi_temp_path " << at << "/u;\nscgi_temp_path "
                          << at << "/s;\nserver {\nlisten 127.0.0.1:" << port << ";\nroot " << at << "/www;\n"
                          << block << "}\n}\n";
    const std::string errors = at + "/errors";
    const char* arguments[] = {program.c_str(), "-c", config.c_str(), "-p", at.c_str(), "-e", errors.c_str(), nullptr};
    if (::posix_spawn(&child_, program.c_str(), nullptr, nullptr, const_cast<char**>(arguments), environ) != 0) return;
    for (int i = 0; i < 500 && !running; ++i) {
      int status = 0;
      if (::waitpid(child_, &status, WNOHANG) == child_) {
        child_ = -1;
        std::ifstream file(errors);
        std::stringstream all;
        all << file.rdbuf();
        UNSCOPED_INFO(all.str());
        return;
      }
      running = fetch(port, "/").status != 0;
      if (!running) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  pid_t child_ = -1;
};

}  // namespace

TEST_CASE("docs/serving.md: configures nginx so that the loader works with it") {
  ServedSite files;
  const std::string bytes = binary_pattern(10'000);
  files.write("a.qnv", bytes);
  files.write("immutable/a.1.qnv", bytes);
  files.write("b.wrl", "#VRML V2.0 utf8\n");
  files.write("b.wrl.gz", "compressed");
  files.write("c.unknown", "?");
  files.write(".hidden", "hidden");
  if (::access("/usr/sbin/nginx", X_OK) != 0) {
    WARN("skipped: nginx is not installed");
    return;
  }
  const DocumentedNginx nginx(fs::path(files.options.folder).parent_path());
  REQUIRE(nginx.running);
  const auto get = [&](const std::string& target, const std::vector<std::string>& headers = {},
                       const std::string& method = {}) { return fetch(nginx.port, target, headers, method); };
  const Got whole = get("/a.qnv");
  CHECK(whole.status == 200);
  CHECK(whole.body == bytes);
  CHECK(whole.headers.at("content-type") == "model/x-qnv");
  CHECK(whole.headers.at("accept-ranges") == "bytes");
  CHECK(whole.headers.at("access-control-allow-origin") == "*");
  CHECK(whole.headers.at("access-control-expose-headers").find("Content-Range") != std::string::npos);
  CHECK(whole.headers.at("x-content-type-options") == "nosniff");
  CHECK(whole.headers.at("cache-control") == "no-cache");
  CHECK(get("/immutable/a.1.qnv").headers.at("cache-control") == "public, max-age=31536000, immutable");
  CHECK(get("/immutable/a.1.qnv").headers.at("access-control-allow-origin") == "*");
  const std::string tag = whole.headers.at("etag");
  CHECK(tag.front() == '"');
  const Got range = get("/a.qnv", {"Range: bytes=100-199", "If-Range: " + tag});
  CHECK(range.status == 206);
  CHECK(range.body == bytes.substr(100, 100));
  CHECK(range.headers.at("content-range") == "bytes 100-199/10000");
  CHECK(range.headers.at("access-control-allow-origin") == "*");
  CHECK(get("/a.qnv", {"Range: bytes=100-199", "If-Range: \"x\""}).status == 200);
  CHECK(get("/a.qnv", {"Range: bytes=10000-"}).status == 416);
  CHECK(get("/a.qnv", {"Range: bytes=0-9,5000-5009"}).headers.at("content-type").starts_with("multipart/byteranges"));
  CHECK(get("/a.qnv", {"If-None-Match: " + tag}).status == 304);
  const Got packed = get("/b.wrl", {"Accept-Encoding: gzip"});
  CHECK(packed.body == "compressed");
  CHECK(packed.headers.at("content-encoding") == "gzip");
  CHECK(packed.headers.at("content-type") == "model/vrml");
  CHECK(packed.headers.at("vary").find("Accept-Encoding") != std::string::npos);
  CHECK(get("/b.wrl").body == "#VRML V2.0 utf8\n");
  CHECK(get("/c.unknown").headers.at("content-type") == "application/octet-stream");
  const Got options = get("/a.qnv", {"Origin: https://example.org"}, "OPTIONS");
  CHECK(options.status == 204);
  CHECK(options.headers.at("access-control-allow-headers").find("If-Range") != std::string::npos);
  CHECK(get("/a.qnv", {}, "DELETE").status == 403);
  CHECK(get("/.hidden").status == 404);
  CHECK(get("/nothing").headers.at("access-control-allow-origin") == "*");
}
