#pragma once

#include "net/cells/cell_driver.h"
#include "net/serve/http_server.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Options of `serve`.
struct ArchiveOptions {
  std::string folder;
  std::optional<std::uint16_t> http_port,
      cells_port;                  // 0 means any free port, nullopt means not served
  std::string bind = "127.0.0.1";  // "*" means all interfaces
  std::uint64_t rate = 0;          // bits per second for all clients, half each for HTTP and cells; 0 means unlimited
  net::CongestionResponse congestion = net::CongestionResponse::equation;  // of cells
  std::string cache;                    // folder for made files; empty means archive_cache_folder()
  bool make = true;                     // makes thumbnails, and streams of other files
  std::string log = "-";                // file; "-" means standard output, empty means none
  std::int64_t max_age = 0;             // seconds
  std::vector<std::string> host_names;  // see net::HttpServerOptions
  /// Origins of web pages that may read the files. If not set: all if the archive is served to other machines, else
  /// none.
  std::optional<std::vector<std::string>> origins;
  std::vector<net::AddressBlock> proxies;
  std::string program = "/proc/self/exe";                  // our program, which makes the files
  std::function<void(const std::string& message)> report;  // see net::HttpServerOptions; may be empty
};

/// Returns $XDG_CACHE_HOME/ghostspace/archive, else ~/.cache/ghostspace/archive; empty if there is no home folder.
[[nodiscard]] std::string archive_cache_folder();

/// Folder that is being served, by own threads.
class Archive {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<Archive>, std::string> start(const ArchiveOptions& options);
  [[nodiscard]] std::optional<std::uint16_t> http_port() const;
  [[nodiscard]] std::optional<std::uint16_t> cells_port() const;
  /// Returns the HTTP server, or null if HTTP is off.
  [[nodiscard]] const net::HttpServer* http() const { return http_.get(); }
  /// Stops serving. Running transfers may finish within `grace`.
  void stop(std::chrono::milliseconds grace);

 private:
  Archive() = default;
  std::unique_ptr<net::CellServerDriver> cells_;  // declared before http_, which reads its statistics
  std::unique_ptr<net::HttpServer> http_;
};

}  // namespace gs::app
