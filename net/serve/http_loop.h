#pragma once

#include "base/noncopyable.h"
#include "net/serve/http_site.h"

#include <microhttpd.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace gs::net {

/// Bytes of memory per connection for the headers of a request.
inline constexpr std::size_t kConnectionMemory = 32768;

/// Thread of an HttpServer. libmicrohttpd handles sockets and HTTP, and calls back only from `run`. All functions run
/// on this thread, except those marked "Any thread".
class HttpLoop : NonCopyable {
 public:
  explicit HttpLoop(HttpServerOptions options);
  ~HttpLoop();

  /// Opens the folder, port and log, and starts to serve. Returns the error, or nullopt.
  [[nodiscard]] std::optional<std::string> start();
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Serves a connected socket. Any thread.
  void adopt(Descriptor socket);
  /// Ends the current wait of the thread. Any thread.
  void wake() const;
  /// Returns the statistics. Any thread.
  [[nodiscard]] HttpServerStatistics statistics() const;
  /// Stops the server after at most `grace`. Any thread.
  void stop(std::chrono::milliseconds grace);

 private:
  enum class Phase : std::uint8_t { receiving, waiting, sending };
  struct Connection {
    HttpLoop* loop = nullptr;
    MHD_Connection* handle = nullptr;
    int socket = -1;
    ClientKey peer{}, client{};  // peer of the connection, and client of the current request
    bool counted = false;
    bool shared = false;  // the peer is a proxy with many clients
    Phase phase = Phase::receiving;
    Instant since{};         // start of the current phase, or last progress in it
    std::size_t credit = 0;  // bytes of the body that may be sent before the next wait for the bandwidth limit
    std::uint64_t sent = 0;  // sent bytes of the response body
  };
  struct Request {
    HttpLoop* loop = nullptr;
    Connection* connection = nullptr;
    HttpRequest request;
    AccessRecord record;
    Instant begin{};
    bool seen = false;             // the headers of the request were read
    bool counted = false;          // counts as a concurrent request of a client behind a proxy
    std::optional<Instant> until;  // end of the wait for a made file
    std::uint64_t id = 0;
  };
  struct Transfer;  // body of a response, while it is sent
  struct Waiting {
    MHD_Connection* handle = nullptr;
    std::size_t lane = 0;
    std::string key;
    Instant until{};
    ContentRequest content = {};
    std::function<std::optional<PostAnswer>()> later = {};
  };

  void run();
  void pace(Instant now);
  void look_at_made(Instant now);
  [[nodiscard]] bool is_still_waiting(const Waiting& waiting) const;
  void drop_slow(Instant now);
  [[nodiscard]] int milliseconds_to_wait(Instant now);
  [[nodiscard]] bool finished(Instant now);
  [[nodiscard]] std::string metrics() const;
  [[nodiscard]] std::optional<std::string> listen();
  void take_adopted();

  MHD_Result handle(Request& request, MHD_Connection* handle, const char* method, const char* version);
  MHD_Result reply(Request& request, MHD_Connection* handle);
  MHD_Result queue(Request& request, MHD_Connection* handle, HttpAnswer answer);
  void completed(Request& request);
  ssize_t read(Transfer& transfer, std::uint64_t at, char* to, std::size_t most);
  ssize_t read_paced(Transfer& transfer, std::uint64_t at, char* to, std::size_t most);

  static void* on_target(void* self, const char* target, MHD_Connection* handle);
  static MHD_Result on_request(void* self, MHD_Connection* handle, const char* url, const char* method,
                               const char* version, const char* upload, std::size_t* upload_size, void** context);
  static void on_completed(void* self, MHD_Connection* handle, void** context, MHD_RequestTerminationCode code);
  static void on_connection(void* self, MHD_Connection* handle, void** context, MHD_ConnectionNotificationCode code);

  HttpServerOptions options_;
  std::unique_ptr<MadeFiles> made_;
  std::unique_ptr<HttpSite> site_;
  ClientLimits limits_;
  MHD_Daemon* daemon_ = nullptr;
  Descriptor listener_, wake_;
  std::uint16_t port_ = 0;
  std::set<Connection*> connections_;
  std::map<std::uint64_t, MHD_Connection*> turns_;  // suspended connections that wait for a turn
  std::map<std::uint64_t, Waiting> waiting_;        // suspended requests that wait for a made file or for content
  std::uint64_t next_id_ = 1;
  bool aborting_ = false, quiet_ = false;
  Instant looked_{};
  mutable std::mutex mutex_;  // guards the members below
  HttpServerStatistics statistics_;
  std::optional<Instant> stop_at_;
  std::vector<Descriptor> adopted_;
  std::thread thread_;
};

}  // namespace gs::net
