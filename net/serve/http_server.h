#pragma once

#include "net/base/address_space.h"
#include "net/limits/client_limits.h"
#include "net/serve/access_log.h"
#include "net/serve/made_files.h"
#include "net/serve/served_folder.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

namespace gs::net {

/// Type of a file, from its name.
struct ServedType {
  std::string mime = "application/octet-stream";
  bool compress = false;  // gzip makes it smaller
};

/// Page that lists a folder.
struct FolderPage {
  std::string mime, body;
};

/// Request for a folder or for something in it.
struct FolderRequest {
  bool json = false;
  std::string query;  // part after the '?', as received
  // Of the folder as the client knows it, such as "http://host:8080/a/"; empty if the request has no host.
  std::string url;
};

/// Kind of file that is generated from another file on demand.
struct Maker {
  std::string name;  // for metrics and keys; letters only
  ServedType type;
  std::string extension;     // of the made file, with its dot
  bool for_missing = false;  // asked only for names that do not exist
  /// Returns the name of the source, in the same folder, for a requested name and its query. Returns nullopt if this
  /// maker does not make that file. Called on the server's thread.
  std::function<std::optional<std::string>(const std::string& name, const std::string& query)> source_of;
  /// Makes `out`, in its own folder, from the file `source`. Returns the error, or nullopt. Called on a thread of this
  /// maker. Should end soon when stopped.
  std::function<std::optional<MakeFailure>(const std::string& source, const std::string& out,
                                           const std::stop_token& stop)>
      make;
  std::chrono::milliseconds wait{10'000};  // maximum wait of a request without Range before it is told to retry
  std::size_t at_once = 4;                 // max files in work, all but the youngest of them slow ones
};

struct HttpServerOptions {
  std::string folder;
  std::string bind = "127.0.0.1";  // IPv4 or IPv6 address; "*" means all
  std::uint16_t port = 0;          // 0 means any free port
  HttpLimits limits;
  std::chrono::milliseconds request_timeout{20'000};  // for a whole request, and between two requests
  std::chrono::milliseconds send_timeout{60'000};     // for sending 64 KiB
  // Seconds for which responses stay fresh; 0 means that each use must validate them.
  std::int64_t max_age = 0;
  std::string made_folder;  // for made files and gzip; empty disables both
  std::uint64_t most_made_bytes = std::uint64_t{4} << 30;
  std::vector<Maker> makers;
  std::function<ServedType(const std::string& name)> type_of;  // if empty, all files are application/octet-stream
  /// Lists a folder. If empty, folders are not listed.
  std::function<FolderPage(const FolderListing& listing, const FolderRequest& request)> list;
  /// Returns a page instead of a missing file of this name, or nullopt for "not found". May be empty.
  std::function<std::optional<FolderPage>(const std::string& name, const FolderRequest& request)> missing;
  /// Returns more lines for /metrics.
  std::function<std::string()> more_metrics;
  /// More host names that the server answers to, if names are checked (HostNames).
  std::vector<std::string> host_names;
  /// Origins of pages that may read the served files (CORS), such as "https://example.org"; "*" means all. If empty,
  /// only pages of this server may.
  std::vector<std::string> origins;
  /// Trusted proxies. For requests through one of them, per-client limits apply to the client that X-Forwarded-For
  /// names.
  std::vector<AddressBlock> proxies;
  /// Receives messages for the operator, such as the reason why a file could not be made. Any thread.
  std::function<void(const std::string& message)> report;
  bool resolve_beneath = true;  // see ServedFolder
  AccessLog log;
};

struct HttpServerStatistics {
  // By status; 0 means that the client left before the response.
  std::map<int, std::uint64_t> requests;
  std::uint64_t bytes = 0;                                 // bytes of bodies
  std::uint64_t connections = 0;                           // current number
  std::uint64_t transfers = 0;                             // current number of requests that are being answered
  std::uint64_t accepted = 0, refused = 0, timed_out = 0;  // connections
};

struct HttpServerError {
  std::string message;
};

/// Serves a folder over HTTP/1.1 on its own thread: GET, HEAD, ranges, validators, gzip, CORS (docs/serving.md). Uses
/// at most about 100 kB of memory per connection. Adds /health and /metrics; only this machine may read /metrics.
class HttpServer {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<HttpServer>, HttpServerError> start(HttpServerOptions options);
  /// Calls stop(0).
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// Any thread.
  [[nodiscard]] HttpServerStatistics statistics() const;
  /// Accepts no more connections and requests, gives running transfers `grace` to end, and waits for them.
  void stop(std::chrono::milliseconds grace);

 private:
  struct State;
  explicit HttpServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::net
