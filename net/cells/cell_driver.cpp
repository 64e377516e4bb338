#include "net/cells/cell_driver.h"

#include "net/base/event_fd.h"
#include "net/limits/clock.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

namespace gs::net {

namespace {

constexpr Instant kLongestWait{1'000'000};
constexpr int kReceivedAtOnce = 256, kSentAtOnce = 256;

std::uint64_t random_number() {
  std::random_device device;
  return std::uint64_t{device()} << 32 | device();
}

/// Sends a datagram. Waits briefly if the system has no buffer space, then drops the datagram.
void send_patiently(UdpSocket& socket, const Endpoint& to, std::span<const std::byte> bytes) {
  if (socket.send(to, bytes)) return;
  socket.wait(Instant(2000), true, -1);
  (void)socket.send(to, bytes);
}

}  // namespace

struct CellServerDriver::State {
  State(CellServerOptions options, std::shared_ptr<CellLibrary> library)
      : server(std::move(options), std::move(library)) {}
  void run() {
    while (!stopping) {
      bell.still();
      turn();
    }
    server.stop();
    while (const auto out = server.next(clock_now())) send_patiently(socket, out->to, out->bytes);
  }
  void turn() {
    Endpoint from;
    for (int i = 0; i < kReceivedAtOnce; ++i) {
      const auto bytes = socket.receive(from);
      if (!bytes) break;
      server.receive(from, *bytes, clock_now());
    }
    for (int i = 0; i < kSentAtOnce; ++i) {
      const auto out = server.next(clock_now());
      if (!out) break;
      send_patiently(socket, out->to, out->bytes);
    }
    {
      const std::scoped_lock lock(mutex);
      statistics = server.statistics();
    }
    const Instant now = clock_now();
    const Instant deadline = server.deadline(now);
    if (deadline > now) socket.wait(std::min(deadline - now, kLongestWait), false, bell.descriptor());
  }

  CellServer server;
  UdpSocket socket;
  EventFd bell;
  std::atomic<bool> stopping = false;
  mutable std::mutex mutex;
  CellServerStatistics statistics;
  std::thread thread;
};

CellServerDriver::CellServerDriver(std::unique_ptr<State> state) : state_(std::move(state)) {
  state_->thread = std::thread([at = state_.get()] { at->run(); });
}

CellServerDriver::~CellServerDriver() {
  state_->stopping = true;
  state_->bell.ring();
  state_->thread.join();
}

std::variant<std::unique_ptr<CellServerDriver>, UdpError> CellServerDriver::start(CellServerOptions options,
                                                                                  std::shared_ptr<CellLibrary> library,
                                                                                  std::uint16_t port, bool loopback) {
  auto socket = UdpSocket::open(port, loopback);
  if (auto* error = std::get_if<UdpError>(&socket)) return std::move(*error);
  if (options.secret == SipKey{}) options.secret = {random_number(), random_number()};
  auto state = std::make_unique<State>(std::move(options), std::move(library));
  state->socket = std::move(std::get<UdpSocket>(socket));
  return std::unique_ptr<CellServerDriver>(new CellServerDriver(std::move(state)));
}

std::uint16_t CellServerDriver::port() const { return state_->socket.port(); }

CellServerStatistics CellServerDriver::statistics() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->statistics;
}

struct CellClientDriver::State {
  State(const CellClientOptions& options, std::string the_host, std::uint16_t the_port, std::function<void()> the_wake)
      : client(options),
        most_waiting(options.most_waiting),
        loss(options.loss),
        chance(options.loss_seed),
        reach(options.reach),
        space_of(options.space_of),
        host(std::move(the_host)),
        port(the_port),
        wake(std::move(the_wake)) {}

  void run() {
    auto found = find_host(host, port, reach, space_of);
    if (const auto* error = std::get_if<UdpError>(&found)) {
      CellEvent event;
      event.text = error->message;
      hand_over({std::move(event)});
      return;
    }
    server = std::get<Endpoint>(found);
    while (!stopping) {
      bell.still();
      take_commands();
      turn();
    }
    client.bye(clock_now());
    while (const auto bytes = client.next(clock_now())) send_patiently(socket, server, *bytes);
  }
  void take_commands() {
    std::deque<std::function<void(CellClient&, Instant)>> taken;
    {
      const std::scoped_lock lock(mutex);
      taken.swap(commands);
    }
    for (const auto& what : taken) what(client, clock_now());
  }
  void turn() {
    Endpoint from;
    // While the owner is slow, leave datagrams in the system. The system drops some, and the losses slow the server
    // down.
    const bool behind = waiting > most_waiting;
    for (int i = 0; i < kReceivedAtOnce && !behind; ++i) {
      const auto bytes = socket.receive(from);
      if (!bytes) break;
      if (from == server && !is_dropped()) client.receive(*bytes, clock_now());
    }
    for (int i = 0; i < kSentAtOnce; ++i) {
      const auto bytes = client.next(clock_now());
      if (!bytes) break;
      send_patiently(socket, server, *bytes);
    }
    hand_over(client.take_events());
    const Instant now = clock_now();
    Instant most = std::min(client.deadline(now) - now, kLongestWait);
    if (behind) {
      std::this_thread::sleep_for(Instant(5000));
      return;
    }
    if (most > Instant(0)) socket.wait(most, false, bell.descriptor());
  }
  bool is_dropped() { return loss > 0 && std::uniform_real_distribution<>(0, 1)(chance) < loss; }
  void hand_over(std::vector<CellEvent> made) {
    const CellClientStatistics latest = client.statistics();
    const bool any = !made.empty();
    {
      const std::scoped_lock lock(mutex);
      statistics = latest;
      for (CellEvent& event : made) {
        waiting += size_of(event);
        events.push_back(std::move(event));
      }
    }
    if (any && wake) wake();
  }
  static std::size_t size_of(const CellEvent& event) {
    return event.bytes.size() + event.head.size() + sizeof(CellEvent);
  }

  CellClient client;
  std::size_t most_waiting;
  double loss;
  std::mt19937_64 chance;
  AddressSpace reach;
  AddressSpaceOf space_of;
  std::string host;
  std::uint16_t port;
  std::function<void()> wake;
  UdpSocket socket;
  Endpoint server;
  EventFd bell;
  std::atomic<bool> stopping = false;
  std::atomic<std::size_t> waiting = 0;  // bytes of events that the owner has not taken
  mutable std::mutex mutex;  // guards the members below
  std::deque<std::function<void(CellClient&, Instant)>> commands;
  std::deque<CellEvent> events;
  CellClientStatistics statistics;
  std::thread thread;
};

CellClientDriver::CellClientDriver(std::unique_ptr<State> state) : state_(std::move(state)) {
  state_->thread = std::thread([at = state_.get()] { at->run(); });
}

CellClientDriver::~CellClientDriver() {
  state_->stopping = true;
  state_->bell.ring();
  state_->thread.join();
}

std::variant<std::unique_ptr<CellClientDriver>, UdpError> CellClientDriver::start(CellClientOptions options,
                                                                                  std::string host, std::uint16_t port,
                                                                                  std::function<void()> wake) {
  auto socket = UdpSocket::open(0, false);
  if (auto* error = std::get_if<UdpError>(&socket)) return std::move(*error);
  if (options.nonce == 0) options.nonce = random_number();
  auto state = std::make_unique<State>(options, std::move(host), port, std::move(wake));
  state->socket = std::move(std::get<UdpSocket>(socket));
  return std::unique_ptr<CellClientDriver>(new CellClientDriver(std::move(state)));
}

void CellClientDriver::command(std::function<void(CellClient&, Instant)> what) {
  {
    const std::scoped_lock lock(state_->mutex);
    state_->commands.push_back(std::move(what));
  }
  state_->bell.ring();
}

void CellClientDriver::want(std::size_t slot, CellWish wish) {
  command([slot, wish = std::move(wish)](CellClient& client, Instant now) { client.want(slot, wish, now); });
}

void CellClientDriver::prefer(std::size_t slot, std::vector<Region> regions, std::vector<ChunkName> chunks) {
  command([slot, regions = std::move(regions), chunks = std::move(chunks)](CellClient& client, Instant) {
    client.prefer(slot, regions, chunks);
  });
}

void CellClientDriver::forget(std::size_t slot, std::vector<ChunkName> chunks) {
  command([slot, chunks = std::move(chunks)](CellClient& client, Instant) { client.forget(slot, chunks); });
}

void CellClientDriver::set_rate(std::uint64_t bits_per_second) {
  command([bits_per_second](CellClient& client, Instant) { client.set_rate(bits_per_second); });
}

std::vector<CellEvent> CellClientDriver::poll(std::size_t most_bytes) {
  std::vector<CellEvent> result;
  std::size_t bytes = 0;
  const std::scoped_lock lock(state_->mutex);
  while (!state_->events.empty() && (bytes < most_bytes || result.empty())) {
    const std::size_t size = State::size_of(state_->events.front());
    bytes += size;
    state_->waiting -= size;
    result.push_back(std::move(state_->events.front()));
    state_->events.pop_front();
  }
  return result;
}

CellClientStatistics CellClientDriver::statistics() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->statistics;
}

}  // namespace gs::net
