#pragma once

#include "base/noncopyable.h"
#include "net/base/address_space.h"
#include "net/base/descriptor.h"
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

/// Content type of a served file.
struct ServedType {
  std::string mime = "application/octet-stream";
  bool compress = false;  // smaller with gzip
};

/// HTML page that lists a folder.
struct FolderPage {
  std::string mime, body;
};

/// Request for a folder or for a name in a folder.
struct FolderRequest {
  bool json = false;
  std::string query;  // part of the target after '?', as received
  // URL of the folder from the client's view, such as "http://host:8080/a/". Empty if the request has no host.
  std::string url;
};

/// Request with the method POST and without a body.
struct PostRequest {
  std::string path, query;    // as received, without '?'
  std::string authorization;  // the field Authorization
};
struct PostAnswer {
  int status = 200;
  std::string message;  // body of the answer, for users
  /// Function that returns the answer when it is ready; empty if this is the answer. The server calls it after
  /// HttpServer::wake(), and several times a second, until it returns an answer. It must not block. If called again, it
  /// returns the same answer.
  std::function<std::optional<PostAnswer>()> later = {};
};

/// Request for content that does not exist in the folder.
struct ContentRequest {
  std::string path;    // decoded, such as "a/b.bin"; ends with '/' if the request names a folder
  std::string within;  // path of the folder that the requesting document may read, as received; empty means no limit
};
/// Content that the program makes while the request waits (HttpServerOptions::content).
struct HeldContent {
  // `waiting`: the server asks again after HttpServer::wake(), and several times a second. `gone`: status 410
  enum class State : std::uint8_t { none, waiting, ready, gone };
  State state = State::none;
  std::string mime, body;  // if ready
};

/// Generator of files: makes a file of one kind from another file on demand.
struct Maker {
  std::string name;  // for metrics and cache keys; letters only
  ServedType type;
  std::string extension;     // extension of the made file, with its dot
  bool for_missing = false;  // used only for names that do not exist in the folder
  /// Returns the name of the source file, in the same folder, for a requested name and query. Returns nullopt if this
  /// maker does not apply. Called on the server's thread.
  std::function<std::optional<std::string>(const std::string& name, const std::string& query)> source_of;
  /// Makes the file `out`, which has its own folder, from the file `source`. Returns the error, or nullopt. Runs on a
  /// thread of this maker. Should end soon after a stop request.
  std::function<std::optional<MakeFailure>(const std::string& source, const std::string& out,
                                           const std::stop_token& stop)>
      make;
  /// Name of the maker of the complete file if this maker makes a coarse version; else empty. A request for the coarse
  /// version also starts the complete file. If that file is ready, the request is refused.
  std::string coarse_of;
  std::chrono::milliseconds wait{10'000};  // maximum wait without Range; then retry
  std::size_t at_once = 4;                 // maximum concurrent files; all but the newest must be slow
};

struct HttpServerOptions {
  std::string folder;
  std::string bind = "127.0.0.1";  // IPv4 or IPv6 address; "*" means all
  std::uint16_t port = 0;          // 0 means any free port
  HttpLimits limits;
  std::chrono::milliseconds request_timeout{20'000};  // time limit for receiving a request, and between two requests
  std::chrono::milliseconds send_timeout{60'000};     // time limit for sending 64 KiB
  // Seconds for which responses are fresh. 0 means that each use must be validated.
  std::int64_t max_age = 0;
  std::string made_folder;  // folder for made files and gzip; empty disables both
  std::uint64_t most_made_bytes = std::uint64_t{4} << 30;
  std::vector<Maker> makers;
  std::function<ServedType(const std::string& name)> type_of;  // by file name; empty: application/octet-stream
  /// Returns the page for a folder. If empty, folders are not listed.
  std::function<FolderPage(const FolderListing& listing, const FolderRequest& request)> list;
  /// Returns a page for a name that does not exist. Returns nullopt for status 404. May be empty.
  std::function<std::optional<FolderPage>(const std::string& name, const FolderRequest& request)> missing;
  /// Returns content that does not exist in the folder. Called on the server's thread before `missing`; may be empty.
  std::function<HeldContent(const ContentRequest& request)> content;
  std::chrono::milliseconds content_wait{20'000};  // maximum wait for content; then retry
  /// Answers a POST request. Called on the server's thread; must check the client's rights, and must not block. Empty
  /// means status 405.
  std::function<PostAnswer(const PostRequest& request)> post;
  /// Returns additional lines for /metrics.
  std::function<std::string()> more_metrics;
  /// Additional host names that the server answers to, if it checks names (HostNames).
  std::vector<std::string> host_names;
  /// Origins of pages that may read the served files (CORS), such as "https://example.org"; "*" means all. If empty,
  /// only pages of this server may read them.
  std::vector<std::string> origins;
  /// Trusted proxies. For their requests, per-client limits apply to the client that X-Forwarded-For names.
  std::vector<AddressBlock> proxies;
  /// Receives messages for the operator, such as the reason why a file cannot be made. Any thread.
  std::function<void(const std::string& message)> report;
  bool resolve_beneath = true;  // as in ServedFolder::open
  bool listen = true;           // opens the port; otherwise, serves only the connections of adopt()
  bool patient = false;         // waits for made files also if a range is requested
  bool to_owner = false;        // serves an account to its own user: follows all links, serves hidden names
  std::string home;             // folder behind "/~/", beneath `folder`; empty means none
  AccessLog log;
};

struct HttpServerStatistics {
  // Requests by status. 0 means that the client left before the response.
  std::map<int, std::uint64_t> requests;
  std::uint64_t bytes = 0;                                 // bytes of response bodies
  std::uint64_t connections = 0;                           // open connections at present
  std::uint64_t transfers = 0;                             // requests that are being answered at present
  std::uint64_t accepted = 0, refused = 0, timed_out = 0;  // numbers of connections
};

struct HttpServerError {
  std::string message;
};

/// Serves a folder over HTTP/1.1 on its own thread: GET, HEAD, ranges, validators, gzip, CORS (docs/serving.md). Uses
/// at most about 100 kB of memory per connection. Also serves /health, and /metrics to this machine only.
class HttpServer : NonCopyable {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<HttpServer>, HttpServerError> start(HttpServerOptions options);
  /// Calls stop(0).
  ~HttpServer();

  [[nodiscard]] std::uint16_t port() const;
  /// Serves a connected socket. Any thread.
  void adopt(Descriptor socket);
  /// Lets the server call `content` again for waiting requests. Any thread.
  void wake();
  /// Returns the statistics. Any thread.
  [[nodiscard]] HttpServerStatistics statistics() const;
  /// Refuses new connections and requests, and waits at most `grace` for running transfers.
  void stop(std::chrono::milliseconds grace);

 private:
  struct State;
  explicit HttpServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::net
