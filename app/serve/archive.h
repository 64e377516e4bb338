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

/// What `serve` is asked for.
struct ArchiveOptions {
  std::string folder;
  std::optional<std::uint16_t> http_port,
      cells_port;                  // 0: any free one; none: not served so
  std::string bind = "127.0.0.1";  // "*": all interfaces
  std::uint64_t rate = 0;          // bits a second of all clients; of HTTP and cells
                                   // half each; 0: no limit
  net::CongestionResponse congestion = net::CongestionResponse::equation;  // of cells
  std::string cache;                    // folder for what is made; empty: archive_cache_folder()
  bool make = true;                     // thumbnails and streams of files that are none
  std::string log = "-";                // file; "-": standard output; empty: none
  std::int64_t max_age = 0;             // seconds
  std::vector<std::string> host_names;  // see net::HttpServerOptions
  /// Pages that may read what is served; not given: all where it is served to others than this machine, else none.
  std::optional<std::vector<std::string>> origins;
  std::vector<net::AddressBlock> proxies;
  std::string program = "/proc/self/exe";                  // ours, which makes
  std::function<void(const std::string& message)> report;  // see net::HttpServerOptions; none: nobody is told
};

/// $XDG_CACHE_HOME/ghostspace/archive, else ~/.cache/ghostspace/archive; empty
/// when there is no home.
[[nodiscard]] std::string archive_cache_folder();

/// A folder that is being served, by threads of its own.
class Archive {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<Archive>, std::string> start(const ArchiveOptions& options);
  [[nodiscard]] std::optional<std::uint16_t> http_port() const;
  [[nodiscard]] std::optional<std::uint16_t> cells_port() const;
  /// Null without HTTP.
  [[nodiscard]] const net::HttpServer* http() const { return http_.get(); }
  /// Lets running transfers end, so long at most.
  void stop(std::chrono::milliseconds grace);

 private:
  Archive() = default;
  std::unique_ptr<net::CellServerDriver> cells_;  // before what asks it for its statistics
  std::unique_ptr<net::HttpServer> http_;
};

}  // namespace gs::app
