#include "net/load/loader.h"

#include <array>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <memory>
#include <mutex>
#include <random>
#include <thread>
#include <unordered_map>

#include "base/noncopyable.h"
#include "net/http/curl_library.h"
#include "net/http/http_cache.h"
#include "net/load/load_engine.h"
#include "net/load/load_queue.h"
#include "net/transfer/transport.h"

namespace gs::net {
namespace {

/// Waiter for threads with transports that have no sockets.
class ConditionWaiter final : public Waiter {
 public:
  void wait(Milliseconds time, std::span<const int>) override {
    std::unique_lock lock(mutex_);
    condition_.wait_for(lock, time, [this] { return woken_; });
    woken_ = false;
  }
  void wake() override {
    const std::lock_guard lock(mutex_);
    woken_ = true;
    condition_.notify_one();
  }

 private:
  std::mutex mutex_;
  std::condition_variable condition_;
  bool woken_ = false;
};

/// Blocks SIGPIPE on this thread. Writing to a closed connection then returns an error and does not end the program.
void ignore_broken_pipes() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

}  // namespace

struct LaneCommand {
  enum class Kind { request, cancel, priority } kind;
  RequestId id;
  int priority = 0;
  Request request;
};

/// Loader thread with its engine and waiter.
class LaneThread : NonCopyable {
 public:
  LaneThread(std::unique_ptr<Waiter> waiter, std::function<std::unique_ptr<LoadEngine>()> make_engine)
      : waiter_(std::move(waiter)), thread_([this, make_engine = std::move(make_engine)] { run(make_engine); }) {}
  ~LaneThread() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    waiter_->wake();
    thread_.join();
  }

  void send(LaneCommand command) {
    {
      const std::lock_guard lock(mutex_);
      commands_.push_back(std::move(command));
    }
    waiter_->wake();
  }
  void wake() { waiter_->wake(); }

 private:
  void run(const std::function<std::unique_ptr<LoadEngine>()>& make_engine) {
    ignore_broken_pipes();
    const std::unique_ptr<LoadEngine> engine = make_engine();
    std::vector<LaneCommand> commands;
    while (take(commands)) {
      for (LaneCommand& command : commands) obey(*engine, command);
      commands.clear();
      const TimePoint now = std::chrono::steady_clock::now();
      constexpr Milliseconds kLongest{60'000};
      Milliseconds time = kLongest;
      if (const auto deadline = engine->step(now)) {
        const auto left = std::chrono::ceil<Milliseconds>(*deadline - std::chrono::steady_clock::now());
        time = std::clamp(left, Milliseconds(0), kLongest);
      }
      const std::vector<int> sockets = engine->readable();
      waiter_->wait(time, sockets);
    }
  }

  bool take(std::vector<LaneCommand>& commands) {
    const std::lock_guard lock(mutex_);
    commands.swap(commands_);
    return !stopping_;
  }

  static void obey(LoadEngine& engine, LaneCommand& command) {
    switch (command.kind) {
      case LaneCommand::Kind::request:
        return engine.request(command.id, std::move(command.request));
      case LaneCommand::Kind::cancel:
        return engine.cancel(command.id);
      case LaneCommand::Kind::priority:
        return engine.set_priority(command.id, command.priority);
    }
  }

  std::unique_ptr<Waiter> waiter_;
  std::mutex mutex_;
  std::vector<LaneCommand> commands_;
  bool stopping_ = false;
  std::thread thread_;  // last member, because the thread uses the members above
};

namespace {

/// Transport that forwards to a transport with another owner. For http, one object is both transport and waiter: an
/// engine owns its transports, but the thread owns the waiter.
class SharedHttp final : public Transport {
 public:
  explicit SharedHttp(Transport& http) : http_(http) {}
  void start(TransferId id, const TransferRequest& request, TimePoint now) override { http_.start(id, request, now); }
  void cancel(TransferId id) override { http_.cancel(id); }
  void pause(TransferId id, bool paused) override { http_.pause(id, paused); }
  void step(TransferSink& sink, TimePoint now) override { http_.step(sink, now); }
  [[nodiscard]] std::optional<TimePoint> deadline(TimePoint now) const override { return http_.deadline(now); }

 private:
  Transport& http_;
};

}  // namespace

struct Loader::Parts {
  explicit Parts(LoaderOptions given)
      : options(std::move(given)),
        queue(options.max_queued_bytes, options.max_queued_bytes_per_request, options.wake) {}

  std::unique_ptr<LoadEngine> make_local_engine() {
    auto engine = std::make_unique<LoadEngine>(options, queue, nullptr);
    engine->add_transport(TransportKind::file, make_file_transport());
    engine->add_transport(TransportKind::data, make_data_transport());
    return engine;
  }

  std::unique_ptr<LoadEngine> make_network_engine(Transport* http) {
    if (!options.cache_folder.empty()) {
      auto opened =
          HttpCache::open({options.cache_folder, options.cache_bytes, options.cache_entries, 0, options.random},
                          options.unix_seconds());
      if (auto* const made = std::get_if<std::unique_ptr<HttpCache>>(&opened)) cache = std::move(*made);
    }
    auto engine = std::make_unique<LoadEngine>(options, queue, cache.get());
    if (http)
      engine->add_transport(TransportKind::http, std::make_unique<SharedHttp>(*http));
    else
      engine->refuse_transport(TransportKind::http, curl().problem);
    if (options.memory) engine->add_transport(TransportKind::memory, options.memory());
    return engine;
  }

  void open_lanes() {
    auto http = make_http_transport(options);
    HttpTransport* const transport = http.get();
    network = transport;
    std::unique_ptr<Waiter> waiter = std::move(http);
    if (!waiter) waiter = std::make_unique<ConditionWaiter>();
    lanes[static_cast<std::size_t>(Lane::network)] =
        std::make_unique<LaneThread>(std::move(waiter), [this, transport] { return make_network_engine(transport); });
    lanes[static_cast<std::size_t>(Lane::local)] =
        std::make_unique<LaneThread>(std::make_unique<ConditionWaiter>(), [this] { return make_local_engine(); });
  }

  /// Wakes the lanes if the queue was full and has room now.
  void wake_the_starved() {
    if (queue.clear_starved())
      for (const auto& each : lanes) each->wake();
  }
  LaneThread& lane(Lane which) { return *lanes[static_cast<std::size_t>(which)]; }

  LoaderOptions options;
  LoadQueue queue;
  std::unique_ptr<HttpCache> cache;  // used on the network thread only
  HttpTransport* network = nullptr;  // owned by the network thread; other threads call only its thread-safe functions
  std::uint64_t last_id = 0;
  std::unordered_map<std::uint64_t, Lane> open;      // lane of each open request
  std::array<std::unique_ptr<LaneThread>, 2> lanes;  // last member, because the threads use the members above
};

Loader::Loader(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Loader::~Loader() = default;

std::unique_ptr<Loader> Loader::create(LoaderOptions options) {
  if (!options.random)
    options.random = [source = std::make_shared<std::mt19937_64>(std::random_device{}())] { return (*source)(); };
  if (!options.unix_seconds)
    options.unix_seconds = [] {
      return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
          .count();
    };
  auto parts = std::make_unique<Parts>(std::move(options));
  parts->open_lanes();
  return std::unique_ptr<Loader>(new Loader(std::move(parts)));
}

RequestId Loader::request(Request request) {
  const RequestId id{++parts_->last_id};
  const std::size_t colon = std::min<std::size_t>(request.url.find(':'), 64);
  const Scheme* const scheme = find_scheme(parse_url(request.url.substr(0, colon) + ":").scheme);
  const Lane lane = scheme ? scheme->lane : Lane::local;
  parts_->queue.open(id, request.priority);
  parts_->open[id.value] = lane;
  parts_->lane(lane).send({LaneCommand::Kind::request, id, 0, std::move(request)});
  return id;
}

void Loader::cancel(RequestId id) {
  const auto found = parts_->open.find(id.value);
  if (found == parts_->open.end()) return;
  parts_->queue.close(id);
  parts_->lane(found->second).send({LaneCommand::Kind::cancel, id, 0, {}});
  parts_->open.erase(found);
  parts_->wake_the_starved();
}

void Loader::set_priority(RequestId id, int priority) {
  const auto found = parts_->open.find(id.value);
  if (found == parts_->open.end()) return;
  parts_->queue.set_priority(id, priority);
  parts_->lane(found->second).send({LaneCommand::Kind::priority, id, priority, {}});
}

void Loader::set_rate(std::uint64_t bytes_per_second) {
  if (parts_->network) parts_->network->set_rate(bytes_per_second);
  parts_->lane(Lane::network).wake();
}

std::vector<LoadEvent> Loader::poll(std::size_t max_bytes) {
  std::vector<LoadEvent> events = parts_->queue.poll(max_bytes);
  for (const LoadEvent& event : events)
    if (std::holds_alternative<LoadDone>(event.what) || std::holds_alternative<LoadError>(event.what))
      parts_->open.erase(event.id.value);
  if (!events.empty()) parts_->wake_the_starved();
  return events;
}

std::size_t Loader::queued_bytes() const { return parts_->queue.queued_bytes(); }

}  // namespace gs::net
