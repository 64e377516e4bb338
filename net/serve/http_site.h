#pragma once

#include "net/base/host_names.h"
#include "net/serve/http_range.h"
#include "net/serve/http_server.h"
#include "net/serve/made_files.h"
#include "net/serve/served_folder.h"

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::net {

/// Request, as far as the response depends on it.
struct HttpRequest {
  std::string method, target;  // both as received
  std::string range, accept, accept_encoding;
  std::string authorization;  // for PostRequest
  bool has_body = false;      // the request has a body, which is not read
  std::string within;         // path of a folder that links in the target must not leave; empty means no limit
  Conditions conditions;
  std::vector<std::string> hosts;  // values of the Host fields
  std::string origin;              // origin of the requesting page; empty if missing
  bool local = false;              // sent by this machine, not through a proxy
  bool waited_long = false;        // the request has already waited the maximum time for a made file
  std::function<std::optional<PostAnswer>()> later = {};  // answer to a POST that the request waits for
};

/// Part of a response body: text, or a range of the response's file.
struct AnswerPart {
  std::string text;
  ServedRange range;
  [[nodiscard]] std::uint64_t size() const { return text.empty() ? range.end - range.begin : text.size(); }
};
/// Response to a request.
struct HttpAnswer {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  std::shared_ptr<const Descriptor> file;
  FileStamp stamp;  // stamp of the file; if the file changes, sending must stop
  std::vector<AnswerPart> parts;
  [[nodiscard]] std::uint64_t size() const;
};
/// Lanes of requests that wait for HttpServerOptions::content, and for PostAnswer::later.
inline constexpr std::size_t kContentLane = std::numeric_limits<std::size_t>::max(), kPostLane = kContentLane - 1;
/// Result if a file must be made first. Repeat the request when the key no longer waits. After `wait`, repeat it with
/// `waited_long`. In kContentLane, `content` takes the role of the key. In kPostLane, `later` does, and the repeated
/// request must contain it.
struct WaitForMade {
  std::size_t lane = 0;
  std::string key;
  std::chrono::milliseconds wait{};
  ContentRequest content = {};
  std::function<std::optional<PostAnswer>()> later = {};
};

/// Makes the responses for a folder over HTTP, without sockets. One thread.
class HttpSite {
 public:
  using Reply = std::variant<HttpAnswer, WaitForMade>;

  /// Creates a site. A null `made` disables made files. Its lanes are those of the makers and a last lane for gzip.
  HttpSite(const HttpServerOptions& options, ServedFolder folder, MadeFiles* made,
           std::function<std::string()> metrics);
  [[nodiscard]] Reply answer(const HttpRequest& request) const;
  /// Returns the response to a client that exceeds its request limit.
  [[nodiscard]] HttpAnswer too_many(const HttpRequest& request) const;
  /// Returns the response to a request that cannot be parsed because of `why`. The connection must close after it.
  [[nodiscard]] static HttpAnswer malformed(const std::string& why);

 private:
  /// Version of a file that may be sent, such as its gzip form.
  struct Representation {
    ServedFile file;
    ServedType type;
    std::string etag;
    std::int64_t modified = 0;  // time of the original file, Unix seconds
    bool gzip = false, varies = false;
  };
  [[nodiscard]] Reply answer_here(const HttpRequest& request) const;
  [[nodiscard]] bool is_for_us(const HttpRequest& request) const;
  [[nodiscard]] std::variant<RequestPath, PathRefusal> path_of(const std::string& text) const;
  [[nodiscard]] Reply post(const HttpRequest& request) const;
  [[nodiscard]] Reply get(const HttpRequest& request, const std::string& path, const std::string& query) const;
  [[nodiscard]] static FolderRequest request_of(const HttpRequest& request, RequestPath path, const std::string& query);
  [[nodiscard]] Reply folder(const HttpRequest& request, const RequestPath& path, const std::string& query) const;
  [[nodiscard]] Reply file(const HttpRequest& request, const RequestPath& path, ServedFile file) const;
  /// Returns the reply with content that the program makes, or nullopt if it has none for the path.
  [[nodiscard]] std::optional<Reply> content(const HttpRequest& request, const RequestPath& path) const;
  [[nodiscard]] std::optional<Reply> made(const HttpRequest& request, const RequestPath& path, const std::string& query,
                                          bool missing) const;
  /// Returns the state and the key of the file that a maker makes from `source`. Starts to make the file if missing.
  [[nodiscard]] std::pair<MadeFile, std::string> request_made(std::size_t lane, const ServedFile& source) const;
  [[nodiscard]] Reply make(const HttpRequest& request, std::size_t lane, const ServedFile& source) const;
  [[nodiscard]] std::optional<WaitForMade> compress(const HttpRequest& request, const RequestPath& path,
                                                    Representation& chosen) const;
  [[nodiscard]] HttpAnswer send(const HttpRequest& request, Representation chosen) const;
  static void add_ranges(HttpAnswer& answer, const std::vector<ServedRange>& ranges, const Representation& chosen);
  [[nodiscard]] HttpAnswer text(const HttpRequest& request, const std::string& mime, std::string body) const;
  [[nodiscard]] static HttpAnswer problem(int status, const std::string& message);
  static void add_common(HttpAnswer& answer);
  void add_sharing(const HttpRequest& request, HttpAnswer& answer) const;
  void add_freshness(HttpAnswer& answer) const;

  const HttpServerOptions& options_;
  HostNames names_;
  ServedFolder root_;
  MadeFiles* made_;
  std::function<std::string()> metrics_;
};

/// Splits the target of a request into path and query. The target may be a complete URL (RFC 9112 3.2.2).
[[nodiscard]] std::pair<std::string, std::string> split_target(std::string target);

/// Rewrites a message about a served file for clients. Replaces the path of the folder by the names that clients use.
/// Replaces the whole message if it names another path of this machine.
[[nodiscard]] std::string message_for_clients(std::string message, const std::string& root);

/// Compresses the file `source` to `out`. Returns the error, or nullopt.
[[nodiscard]] std::optional<MakeFailure> gzip_file(const std::string& source, const std::string& out,
                                                   const std::stop_token& stop);

}  // namespace gs::net
