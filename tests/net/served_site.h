#pragma once

#include "base/noncopyable.h"
#include "net/serve/http_server.h"
#include "tests/net/http_client.h"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <unistd.h>

namespace gs::net::test {

/// Served folder with a folder for made files beside it; both are temporary.
class ServedSite : NonCopyable {
 public:
  ServedSite() {
    static std::atomic<int> count{0};
    base_ = std::filesystem::temp_directory_path() /
            ("ghostspace-served-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(base_ / "www");
    std::filesystem::create_directories(base_ / "made");
    options.folder = (base_ / "www").string();
  }
  ~ServedSite() {
    server.reset();
    std::filesystem::remove_all(base_);
  }

  /// Writes a file of the served folder; "../x" is beside it.
  void write(const std::string& name, const std::string& bytes) const {
    const auto path = std::filesystem::path(options.folder) / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return options.folder + "/" + name; }
  [[nodiscard]] std::string made() const { return (base_ / "made").string(); }
  void start() {
    auto started = HttpServer::start(std::exchange(options, {}));
    options.folder = (base_ / "www").string();
    if (auto* problem = std::get_if<HttpServerError>(&started)) FAIL(problem->message);
    server = std::move(std::get<std::unique_ptr<HttpServer>>(started));
    port = server->port();
  }
  [[nodiscard]] Got get(const std::string& target, const std::vector<std::string>& headers = {},
                        const std::string& method = {}) const {
    return fetch(port, target, headers, method);
  }

  HttpServerOptions options;
  std::unique_ptr<HttpServer> server;
  std::uint16_t port = 0;

 private:
  std::filesystem::path base_;
};

/// Returns bytes that differ from their neighbours.
inline std::string binary_pattern(std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>((i * 2654435761U) >> 13U);
  return bytes;
}

}  // namespace gs::net::test
