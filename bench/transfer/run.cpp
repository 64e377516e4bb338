#include "bench/transfer/run.h"

#include "base/noncopyable.h"
#include "net/cells/cell_driver.h"
#include "net/load/loader.h"

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <variant>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gs::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::uint16_t kHttpPort = 8080, kCellsPort = 6635;

/// `ghostspace serve` as a child on the server's host, killed at the end.
class ServerProcess : NonCopyable {
 public:
  ~ServerProcess() {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
    if (messages_ >= 0) ::close(messages_);
  }
  /// Starts the server on the host's thread. Returns an error, or nullopt once it listens.
  [[nodiscard]] std::optional<std::string> start(const ServerSpec& spec);

 private:
  [[nodiscard]] std::optional<std::string> wait_for_word() const;

  pid_t child_ = -1;
  int messages_ = -1;
};

std::optional<std::string> ServerProcess::start(const ServerSpec& spec) {
  // Listens on all interfaces, because cells can only listen on all or on the loopback. Without a rate, HTTP is
  // unlimited, and cells send 50 Mbit/s per client.
  std::vector<std::string> words{spec.program, "serve", spec.folder, "--http", std::to_string(kHttpPort)};
  for (const char* word : {"--bind", "*", "--log", "/dev/null", "--cells"}) words.emplace_back(word);
  words.push_back(std::to_string(kCellsPort));
  words.insert(words.end(), {"--cache", spec.scratch});
  words.insert(words.end(), spec.arguments.begin(), spec.arguments.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return "no pipe for the server";
  child_ = ::fork();
  if (child_ == 0) {
    // The parent has other threads, so only system calls are safe here. The child must not outlive the parent.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::dup2(ends[1], STDERR_FILENO);
    ::execv(spec.program.c_str(), arguments.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  messages_ = ends[0];
  return child_ > 0 ? wait_for_word() : "no process for the server";
}

// Waits until the server listens. It prints a message for each port on stderr, with cells last.
std::optional<std::string> ServerProcess::wait_for_word() const {
  constexpr auto kPatience = std::chrono::seconds(20);
  const auto until = Clock::now() + kPatience;
  std::string said;
  while (said.find("on cells://") == std::string::npos) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    pollfd wait{messages_, POLLIN, 0};
    if (left <= 0 || ::poll(&wait, 1, static_cast<int>(left)) <= 0) return "the server does not start: " + said;
    char buffer[512];
    const ssize_t got = ::read(messages_, buffer, sizeof buffer);
    if (got <= 0) return "the server ends: " + said;
    said.append(buffer, static_cast<std::size_t>(got));
  }
  return std::nullopt;
}

/// Signal from another thread.
class Wake {
 public:
  void ring() {
    const std::lock_guard lock(mutex_);
    rung_ = true;
    changed_.notify_one();
  }
  void wait_until(Clock::time_point until) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, until, [&] { return rung_; });
    rung_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool rung_ = false;
};

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

Clock::time_point limit_of(Clock::time_point start, double seconds) {
  return start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// Handles an event of a loader. Returns true when the transfer has ended.
bool take_load(const net::LoadEvent& event, double seconds, const TransferSpec& spec, Recording& recording) {
  if (const auto* data = std::get_if<net::LoadData>(&event.what)) {
    recording.arrivals.push_back({seconds, data->offset + data->bytes.size()});
    recording.complete = spec.enough > 0 && recording.arrivals.back().bytes >= spec.enough;
  } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
    recording.arrivals.clear();
  } else if (std::holds_alternative<net::LoadDone>(event.what)) {
    recording.complete = true;
    if (spec.enough == 0 && (recording.arrivals.empty() || recording.arrivals.back().bytes != spec.size))
      recording.problem = "not the bytes of the file came";
  } else if (const auto* error = std::get_if<net::LoadError>(&event.what)) {
    recording.failure = error->message;
  }
  return recording.complete || !recording.failure.empty();
}

Clock::time_point fetch_http(const TransferSpec& spec, Recording& recording) {
  Wake wake;
  net::LoaderOptions options;
  options.wake = [&wake] { wake.ring(); };
  options.proxy_from_environment = false;
  const auto loader = net::Loader::create(std::move(options));
  net::Request request;
  request.url =
      "http://" + std::string(EmulatedLink::kServerAddress) + ":" + std::to_string(kHttpPort) + "/" + spec.file;
  request.cache = net::CacheUse::never_store;
  if (spec.one_range) request.ranges = {{0, spec.size}};
  const auto start = Clock::now(), until = limit_of(start, spec.limit);
  (void)loader->request(request);
  for (bool over = false; !over && Clock::now() < until;) {
    if (loader->queued_bytes() == 0) wake.wait_until(until);
    for (const net::LoadEvent& event : loader->poll()) {
      if (over) break;
      over = take_load(event, seconds_between(start, Clock::now()), spec, recording);
    }
  }
  return start;
}

// Handles an event of a cell client. Returns true when the transfer has ended.
bool take_cells(net::CellEvent event, double seconds, const TransferSpec& spec, std::uint64_t& bytes,
                Recording& recording) {
  using EventKind = net::CellEvent::Kind;
  if (event.kind == EventKind::base || event.kind == EventKind::piece) {
    bytes += event.bytes.size();
    recording.cells.push_back({seconds, std::move(event)});
    recording.complete = spec.enough > 0 && bytes >= spec.enough;
  } else if (event.kind == EventKind::ended) {
    recording.complete = true;
  } else if (event.kind == EventKind::failed || event.kind == EventKind::refused) {
    recording.failure = event.text;
  }
  return recording.complete || !recording.failure.empty();
}

Clock::time_point fetch_cells(const TransferSpec& spec, Recording& recording) {
  // Leaves room for UDP and IP headers beside the grant.
  constexpr double kOfLine = 0.95;
  Wake wake;
  net::CellClientOptions options;
  options.rate = static_cast<std::uint64_t>(spec.link.bits_per_second * kOfLine);
  auto started =
      net::CellClientDriver::start(options, EmulatedLink::kServerAddress, kCellsPort, [&wake] { wake.ring(); });
  if (const auto* error = std::get_if<net::UdpError>(&started)) {
    recording.problem = error->message;
    return Clock::now();
  }
  auto& client = *std::get<std::unique_ptr<net::CellClientDriver>>(started);
  net::CellWish wish;
  wish.path = spec.file;
  const auto start = Clock::now(), until = limit_of(start, spec.limit);
  client.want(0, wish);
  std::uint64_t bytes = 0;
  constexpr std::size_t kAtOnce = std::size_t{1} << 20;
  for (bool over = false; !over && Clock::now() < until;) {
    auto events = client.poll(kAtOnce);
    if (events.empty()) wake.wait_until(until);
    for (net::CellEvent& event : events) {
      if (over) break;
      over = take_cells(std::move(event), seconds_between(start, Clock::now()), spec, bytes, recording);
    }
  }
  recording.cell_counts = client.statistics();
  return start;
}

}  // namespace

double Recording::last() const {
  return std::max(arrivals.empty() ? 0 : arrivals.back().seconds, cells.empty() ? 0 : cells.back().seconds);
}

std::optional<double> Recording::when(std::uint64_t bytes) const {
  const auto found = std::find_if(arrivals.begin(), arrivals.end(), [&](const Arrival& a) { return a.bytes >= bytes; });
  return found == arrivals.end() ? std::nullopt : std::optional(found->seconds);
}

Recording transfer(const TransferSpec& spec, const ServerSpec& server) {
  Recording recording;
  auto made = EmulatedLink::create(spec.link, spec.congestion_control);
  if (const auto* problem = std::get_if<std::string>(&made)) {
    recording.problem = *problem;
    return recording;
  }
  EmulatedLink& link = *std::get<std::unique_ptr<EmulatedLink>>(made);
  ServerProcess process;  // destroyed before its host
  link.on_server([&] {
    if (const auto problem = process.start(server)) recording.problem = *problem;
  });
  if (!recording.problem.empty()) return recording;
  link.on_client([&] {
    const auto start = spec.cells ? fetch_cells(spec, recording) : fetch_http(spec, recording);
    if (const auto first = link.first_at_client()) recording.connected = seconds_between(start, *first);
  });
  recording.link = link.counts();
  return recording;
}

bool serve_has_option(const std::string& program, const std::string& option) {
  std::FILE* const help = ::popen(("'" + program + "' serve --help 2>/dev/null").c_str(), "r");
  if (!help) return false;
  std::string text;
  char buffer[1024];
  while (const std::size_t got = std::fread(buffer, 1, sizeof buffer, help)) text.append(buffer, got);
  ::pclose(help);
  return text.find(option + " ") != std::string::npos;
}

}  // namespace gs::bench
