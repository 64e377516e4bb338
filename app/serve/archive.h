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

/// Options of the command `serve`.
struct ArchiveOptions {
  std::string folder;             // empty, for `standard_streams` only: all files of this account
  bool standard_streams = false;  // true serves the connections of Archive::adopt() only
  std::optional<std::uint16_t> http_port,
      cells_port;                  // 0 means any free port; nullopt means that the protocol is off
  std::string bind = "127.0.0.1";  // "*" means all interfaces
  std::uint64_t rate = 0;          // bits/s for all clients, half for HTTP and half for cells; 0 means unlimited
  net::CongestionResponse congestion = net::CongestionResponse::equation;  // of cell transfers
  std::string cache;         // folder for made files; empty means archive_cache_folder()
  bool make = true;          // make thumbnails of worlds, and streams of files in other formats
  std::string log = "-";     // file; "-" means standard output, empty means none
  std::int64_t max_age = 0;  // seconds for which clients and CDNs may reuse a response
  std::size_t connections = net::HttpLimits{}.connections;  // max number of HTTP connections
  std::vector<std::string> host_names;                      // see net::HttpServerOptions
  /// Origins of web pages that may read the files. If nullopt: every origin if `bind` lets other machines connect, else
  /// none.
  std::optional<std::vector<std::string>> origins;
  std::vector<net::AddressBlock> proxies;
  /// For `standard_streams` without a folder: see net::HttpServerOptions. Called on the server's thread.
  std::function<net::HeldContent(const net::ContentRequest& request)> content;
  std::function<net::PostAnswer(const net::PostRequest& request)> post;
  std::string program = "/proc/self/exe";                  // this program; it makes files in child processes
  std::function<void(const std::string& message)> report;  // see net::HttpServerOptions; may be empty
};

/// Returns $XDG_CACHE_HOME/ghostspace/archive, else ~/.cache/ghostspace/archive; empty if there is no home folder.
[[nodiscard]] std::string archive_cache_folder();

/// Server of a folder, by HTTP and cells. Has its own threads.
class Archive {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<Archive>, std::string> start(const ArchiveOptions& options);
  [[nodiscard]] std::optional<std::uint16_t> http_port() const;
  [[nodiscard]] std::optional<std::uint16_t> cells_port() const;
  /// Serves a connected socket, if `standard_streams`. Any thread.
  void adopt(net::Descriptor socket) { http_->adopt(std::move(socket)); }
  /// Lets the server call `content` again for waiting requests. Any thread.
  void wake() { http_->wake(); }
  /// Returns the HTTP server; null if HTTP is off.
  [[nodiscard]] const net::HttpServer* http() const { return http_.get(); }
  /// Stops serving. Running transfers may continue for the time `grace`.
  void stop(std::chrono::milliseconds grace);

 private:
  Archive() = default;
  std::unique_ptr<net::CellServerDriver> cells_;  // declared before http_, which reads the statistics of cells_
  std::unique_ptr<net::HttpServer> http_;
};

}  // namespace gs::app
