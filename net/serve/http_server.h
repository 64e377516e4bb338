#pragma once

#include "net/base/address_space.h"
#include "net/base/client_limits.h"
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

/// What a file is, by its name.
struct ServedType {
  std::string mime = "application/octet-stream";
  bool compress = false;  // gzip makes it smaller
};

/// A page that lists a folder.
struct FolderPage {
  std::string mime, body;
};

/// How a folder, or something in it, is asked for.
struct FolderRequest {
  bool json = false;
  std::string query;  // behind the '?', as it came
  std::string url;  // of the folder as the client knows it, "http://host:8080/a/"; empty: it does not say by which name
};

/// A kind of file that is made of another when someone asks for it.
struct Maker {
  std::string name;  // in metrics and keys: letters only
  ServedType type;
  std::string extension;     // of what is made, with its point
  bool for_missing = false;  // asked only for names that are not there
  /// The name of the source, in the same folder, of what is asked for by a name
  /// and the query behind it; nothing when this maker does not make it. On the
  /// server's thread.
  std::function<std::optional<std::string>(const std::string& name, const std::string& query)> source_of;
  /// Makes `out`, in a folder of its own, of the file `source`; what went wrong, if it did. On a thread of this
  /// maker's; should end soon when stopped.
  std::function<std::optional<MakeFailure>(const std::string& source, const std::string& out,
                                           const std::stop_token& stop)>
      make;
  std::chrono::milliseconds wait{10'000};  // so long a request without Range waits before it is told to
                                           // come again
  std::size_t at_once = 4;                 // max files in work, all but the youngest of them slow ones
};

struct HttpServerOptions {
  std::string folder;
  std::string bind = "127.0.0.1";  // an address of IPv4 or IPv6; "*": all
  std::uint16_t port = 0;          // 0: any free one
  HttpLimits limits;
  std::chrono::milliseconds request_timeout{20'000};  // for a request to arrive as a whole, and between two
  std::chrono::milliseconds send_timeout{60'000};     // for 64 KiB to be taken
  std::int64_t max_age = 0;                           // seconds that answers stay fresh; 0: to be validated each time
  std::string made_folder;                            // for what is made, gzip too; empty: nothing is made
  std::uint64_t most_made_bytes = std::uint64_t{4} << 30;
  std::vector<Maker> makers;
  std::function<ServedType(const std::string& name)> type_of;  // none: all are application/octet-stream
  /// None: folders are not listed.
  std::function<FolderPage(const FolderListing& listing, const FolderRequest& request)> list;
  /// A page in the place of a file of this name, which is not there; nothing: it is not found. None: none is.
  std::function<std::optional<FolderPage>(const std::string& name, const FolderRequest& request)> missing;
  /// Lines for /metrics of others than this server.
  std::function<std::string()> more_metrics;
  /// More names that the server answers for where those are looked at; see HostNames.
  std::vector<std::string> host_names;
  /// Pages that may read what is served (CORS), by their origins ("https://example.org"); "*": all. None: no others
  /// than our own.
  std::vector<std::string> origins;
  /// Whose X-Forwarded-For is believed: the limits of one client are then for whom it names.
  std::vector<AddressBlock> proxies;
  /// Told what whoever serves should know and clients must not: why something could not be made. Any thread.
  std::function<void(const std::string& message)> report;
  bool resolve_beneath = true;  // see ServedFolder
  AccessLog log;
};

struct HttpServerStatistics {
  std::map<int, std::uint64_t> requests;                   // by status; 0: the client went away before it was answered
  std::uint64_t bytes = 0;                                 // of bodies
  std::uint64_t connections = 0;                           // now
  std::uint64_t transfers = 0;                             // now: requests that are being answered
  std::uint64_t accepted = 0, refused = 0, timed_out = 0;  // connections
};

struct HttpServerError {
  std::string message;
};

/// Serves a folder over HTTP/1.1 by a thread of its own: GET, HEAD, ranges,
/// validators, gzip, CORS; see docs/serving.md. Memory is bounded by about 100
/// kB a connection. /health and /metrics are its own; /metrics is for this
/// machine only.
class HttpServer {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<HttpServer>, HttpServerError> start(HttpServerOptions options);
  /// As stop(0).
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// Any thread.
  [[nodiscard]] HttpServerStatistics statistics() const;
  /// Takes no more connections and requests, gives running transfers so long to
  /// end, and waits for that.
  void stop(std::chrono::milliseconds grace);

 private:
  struct State;
  explicit HttpServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::net
