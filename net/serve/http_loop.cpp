#include "net/serve/http_loop.h"

#include "net/limits/clock.h"
#include "net/serve/microhttpd_library.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <limits>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace gs::net {
namespace {

constexpr Instant kLookEvery{100'000};

// Disables decoding in libmicrohttpd, which would end the target at an encoded NUL. parse_request_path() decodes it.
std::size_t leave_encoded(void*, MHD_Connection*, char* text) { return std::strlen(text); }

std::optional<std::string> problem(const std::string& what) { return what + ": " + std::strerror(errno); }

}  // namespace

HttpLoop::HttpLoop(HttpServerOptions options)
    : options_(std::move(options)),
      limits_(options_.limits, clock_now()),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

HttpLoop::~HttpLoop() {
  stop(std::chrono::milliseconds(0));
  made_.reset();
}

std::optional<std::string> HttpLoop::listen() {
  const bool all = options_.bind == "*";
  sockaddr_in four{};
  sockaddr_in6 six{};
  four.sin_family = AF_INET;
  six.sin6_family = AF_INET6;
  four.sin_port = six.sin6_port = htons(options_.port);
  const bool is_four = !all && ::inet_pton(AF_INET, options_.bind.c_str(), &four.sin_addr) == 1;
  if (!all && !is_four && ::inet_pton(AF_INET6, options_.bind.c_str(), &six.sin6_addr) != 1)
    return "'" + options_.bind + "' is not an IPv4 or IPv6 address or '*'";
  listener_ = Descriptor(::socket(is_four ? AF_INET : AF_INET6, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  bool plain = is_four;
  if (!listener_ && all) {  // the system has no IPv6: use IPv4
    listener_ = Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    plain = true;
  }
  if (!listener_) return problem("cannot open a socket");
  const int on = 1, off = 0;
  (void)::setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (!plain) (void)::setsockopt(listener_.get(), IPPROTO_IPV6, IPV6_V6ONLY, all ? &off : &on, sizeof on);
  const auto* address = plain ? reinterpret_cast<const sockaddr*>(&four) : reinterpret_cast<const sockaddr*>(&six);
  const auto size = static_cast<socklen_t>(plain ? sizeof four : sizeof six);
  if (::bind(listener_.get(), address, size) != 0 || ::listen(listener_.get(), 1024) != 0)
    return problem("cannot listen on " + options_.bind + " port " + std::to_string(options_.port));
  sockaddr_in6 bound{};
  socklen_t length = sizeof bound;
  (void)::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&bound), &length);
  port_ = ntohs(bound.sin6_port);  // the port has the same offset in both families
  return std::nullopt;
}

std::optional<std::string> HttpLoop::start() {
  if (!wake_) return problem("cannot create an event descriptor");
  auto folder = ServedFolder::open(options_.folder, options_.resolve_beneath, options_.to_owner);
  if (auto* message = std::get_if<std::string>(&folder)) return *message;
  if (!options_.made_folder.empty()) {
    MadeFiles::Options made;
    made.folder = options_.made_folder;
    made.most_bytes = options_.most_made_bytes;
    std::vector<std::size_t> at_once;
    for (const Maker& maker : options_.makers) at_once.push_back(maker.at_once);
    at_once.push_back(1);  // the last lane is for gzip, with one thread
    made_ = std::make_unique<MadeFiles>(made, at_once, [this] { wake(); });
  }
  site_ = std::make_unique<HttpSite>(options_, std::move(std::get<ServedFolder>(folder)), made_.get(),
                                     [this] { return metrics(); });
  if (!microhttpd().problem.empty()) return microhttpd().problem;
  if (options_.listen)
    if (auto message = listen()) return message;
  const auto most = static_cast<unsigned>(std::min<std::size_t>(
      options_.limits.connections > 0 ? options_.limits.connections : 1U << 20, std::numeric_limits<int>::max()));
  const auto flags = static_cast<unsigned>(MHD_USE_EPOLL) | static_cast<unsigned>(MHD_ALLOW_SUSPEND_RESUME) |
                     (options_.listen ? 0U : static_cast<unsigned>(MHD_USE_NO_LISTEN_SOCKET));
  // libmicrohttpd owns the listener now and closes it. It rejects the option without a listener, so the list ends
  // there.
  daemon_ = microhttpd().MHD_start_daemon(
      flags, port_, nullptr, nullptr, &HttpLoop::on_request, this, MHD_OPTION_CONNECTION_LIMIT, most,
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionMemory, MHD_OPTION_URI_LOG_CALLBACK, &HttpLoop::on_target, this,
      MHD_OPTION_UNESCAPE_CALLBACK, &leave_encoded, nullptr, MHD_OPTION_NOTIFY_COMPLETED, &HttpLoop::on_completed, this,
      MHD_OPTION_NOTIFY_CONNECTION, &HttpLoop::on_connection, this, MHD_OPTION_STRICT_FOR_CLIENT, 1,
      options_.listen ? MHD_OPTION_LISTEN_SOCKET : MHD_OPTION_END,
      options_.listen ? ::fcntl(listener_.get(), F_DUPFD_CLOEXEC, 0) : MHD_INVALID_SOCKET, MHD_OPTION_END);
  if (!daemon_) return "libmicrohttpd cannot start";
  listener_.close();
  thread_ = std::thread([this] { run(); });
  return std::nullopt;
}

void HttpLoop::adopt(Descriptor socket) {
  {
    const std::lock_guard lock(mutex_);
    adopted_.push_back(std::move(socket));
  }
  wake();
}

void HttpLoop::take_adopted() {
  std::vector<Descriptor> adopted;
  {
    const std::lock_guard lock(mutex_);
    adopted.swap(adopted_);
  }
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  // libmicrohttpd owns the socket from then on, and closes it also on failure.
  for (Descriptor& socket : adopted)
    (void)microhttpd().MHD_add_connection(daemon_, socket.release(), reinterpret_cast<const sockaddr*>(&address),
                                          sizeof address.sun_family);
}

void HttpLoop::wake() const {
  const std::uint64_t one = 1;
  (void)!::write(wake_.get(), &one, sizeof one);
}

void HttpLoop::stop(std::chrono::milliseconds grace) {
  {
    const std::lock_guard lock(mutex_);
    const Instant at = clock_now() + std::chrono::duration_cast<Instant>(grace);
    stop_at_ = stop_at_ ? std::min(*stop_at_, at) : at;
  }
  wake();
  if (thread_.joinable()) thread_.join();
}

HttpServerStatistics HttpLoop::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

// Reports whether the server thread may end: all responses were sent, or the grace time is over.
bool HttpLoop::finished(Instant now) {
  Instant at{};
  std::uint64_t transfers = 0;
  {
    const std::lock_guard lock(mutex_);
    if (!stop_at_) return false;
    at = *stop_at_;
    transfers = statistics_.transfers;
  }
  if (!quiet_) {
    quiet_ = true;
    const MHD_socket listener = microhttpd().MHD_quiesce_daemon(daemon_);
    if (listener != MHD_INVALID_SOCKET) ::close(listener);
  }
  // Close connections that wait for their next request.
  for (const Connection* connection : connections_)
    if (connection->phase == Phase::receiving) (void)::shutdown(connection->socket, SHUT_RD);
  return transfers == 0 || now >= at;
}

void HttpLoop::run() {
  const MHD_DaemonInfo* info = microhttpd().MHD_get_daemon_info(daemon_, MHD_DAEMON_INFO_EPOLL_FD);
  pollfd waits[2] = {{info ? info->epoll_fd : -1, POLLIN, 0}, {wake_.get(), POLLIN, 0}};
  for (;;) {
    take_adopted();
    (void)microhttpd().MHD_run(daemon_);
    const Instant now = clock_now();
    if (finished(now)) break;
    // Only MHD_run continues resumed connections, and no socket event causes it. So do not wait after a resume.
    const std::size_t suspended = turns_.size() + waiting_.size();
    pace(now);
    look_at_made(now);
    const bool resumed = turns_.size() + waiting_.size() < suspended;
    drop_slow(now);
    (void)::poll(waits, 2, resumed ? 0 : milliseconds_to_wait(now));
    std::uint64_t count = 0;
    if ((waits[1].revents & POLLIN) != 0) (void)!::read(wake_.get(), &count, sizeof count);
  }
  // libmicrohttpd can stop only if no connection is suspended.
  aborting_ = true;
  for (const auto& [id, handle] : turns_) microhttpd().MHD_resume_connection(handle);
  for (const auto& [id, waiting] : waiting_) microhttpd().MHD_resume_connection(waiting.handle);
  turns_.clear();
  waiting_.clear();
  (void)microhttpd().MHD_run(daemon_);
  microhttpd().MHD_stop_daemon(daemon_);
  daemon_ = nullptr;
}

void HttpLoop::pace(Instant now) {
  while (const auto turn = limits_.next(now)) {
    const auto found = turns_.find(*turn);
    if (found == turns_.end()) continue;
    const MHD_ConnectionInfo* info =
        microhttpd().MHD_get_connection_info(found->second, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    auto* connection = static_cast<Connection*>(info->socket_context);
    connection->credit += limits_.piece();
    connection->phase = Phase::sending;
    connection->since = now;
    microhttpd().MHD_resume_connection(found->second);
    turns_.erase(found);
  }
}

bool HttpLoop::is_still_waiting(const Waiting& waiting) const {
  try {
    if (waiting.lane == kPostLane) return !waiting.later();
    if (waiting.lane == kContentLane) return options_.content(waiting.content).state == HeldContent::State::waiting;
  } catch (const std::exception&) {
    return false;  // the repeated request fails and closes its connection
  }
  return made_->is_waiting(waiting.lane, waiting.key);
}

void HttpLoop::look_at_made(Instant now) {
  for (auto at = waiting_.begin(); at != waiting_.end();) {
    if (now < at->second.until && is_still_waiting(at->second)) {
      ++at;
      continue;
    }
    microhttpd().MHD_resume_connection(at->second.handle);
    at = waiting_.erase(at);
  }
}

void HttpLoop::drop_slow(Instant now) {
  if (now - looked_ < kLookEvery) return;
  looked_ = now;
  for (Connection* connection : connections_) {
    if (connection->phase == Phase::waiting) continue;
    const auto most = connection->phase == Phase::receiving ? options_.request_timeout : options_.send_timeout;
    if (now - connection->since <= std::chrono::duration_cast<Instant>(most)) continue;
    (void)::shutdown(connection->socket, SHUT_RDWR);
    connection->since = now;
    const std::lock_guard lock(mutex_);
    ++statistics_.timed_out;
  }
}

int HttpLoop::milliseconds_to_wait(Instant now) {
  Instant until = Instant::max();
  // Wake regularly to find slow connections and to check the end of the grace time.
  if (!connections_.empty() || quiet_) until = now + kLookEvery;
  for (const auto& [id, waiting] : waiting_) until = std::min(until, waiting.until);
  until = std::min(until, limits_.deadline(now));
  MHD_UNSIGNED_LONG_LONG most = 0;
  if (microhttpd().MHD_get_timeout(daemon_, &most) == MHD_YES) until = std::min(until, now + Instant(most * 1000));
  if (until == Instant::max()) return -1;
  return static_cast<int>(std::clamp<std::int64_t>(((until - now).count() + 999) / 1000, 0, 60'000));
}

std::string HttpLoop::metrics() const {
  const HttpServerStatistics now = statistics();
  std::string text = "# TYPE ghostspace_http_requests_total counter\n";
  for (const auto& [status, count] : now.requests)
    text += "ghostspace_http_requests_total{status=\"" + std::to_string(status) + "\"} " + std::to_string(count) + "\n";
  const auto add = [&](const std::string& name, const char* type, const std::string& labels, std::uint64_t value) {
    if (type) text += "# TYPE ghostspace_" + name + " " + type + "\n";
    text += "ghostspace_" + name + labels + " " + std::to_string(value) + "\n";
  };
  add("http_sent_bytes_total", "counter", "", now.bytes);
  add("http_connections", "gauge", "", now.connections);
  add("http_transfers", "gauge", "", now.transfers);
  add("http_connections_accepted_total", "counter", "", now.accepted);
  add("http_connections_refused_total", "counter", "", now.refused);
  add("http_connections_timed_out_total", "counter", "", now.timed_out);
  if (made_) {
    text +=
        "# TYPE ghostspace_made_total counter\n# TYPE "
        "ghostspace_made_failed_total counter\n"
        "# TYPE ghostspace_made_waiting gauge\n";
    for (std::size_t lane = 0; lane <= options_.makers.size(); ++lane) {
      const std::string name = lane < options_.makers.size() ? options_.makers[lane].name : "gzip";
      const std::string labels = "{kind=\"" + name + "\"}";
      const MadeFiles::Statistics made = made_->statistics(lane);
      add("made_total", nullptr, labels, made.made);
      add("made_failed_total", nullptr, labels, made.failed);
      add("made_waiting", nullptr, labels, made.waiting);
    }
  }
  if (options_.more_metrics) text += options_.more_metrics();
  return text;
}

}  // namespace gs::net
