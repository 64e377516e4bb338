#include "bench/transfer/link_emulator.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <span>
#include <stop_token>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

namespace gs::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kMtu = 1500;
constexpr int kNetworkBits = 24;
constexpr const char* kDevice = "link0";
// The device accepts whole bursts, so that they wait in the emulated queue.
constexpr std::uint32_t kDeviceQueue = 10'000;  // packets
constexpr int kReadAtOnce = 64;
constexpr std::int64_t kLate = 1'000'000;  // nanoseconds

class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] int get() const { return number_; }

 private:
  int number_;
};

/// Thread that runs tasks in sequence.
class HostThread {
 public:
  HostThread() : thread_([this](const std::stop_token& stop) { serve(stop); }) {}

  void run(const std::function<void()>& work) {
    std::unique_lock lock(mutex_);
    work_ = &work;
    changed_.notify_all();
    changed_.wait(lock, [&] { return work_ == nullptr; });
  }

 private:
  void serve(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [&] { return work_ != nullptr; })) {
      lock.unlock();
      (*work_)();
      lock.lock();
      work_ = nullptr;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  const std::function<void()>* work_ = nullptr;
  std::jthread thread_;  // last: joins before the members that it uses are destroyed
};

std::string failed(const char* what) { return std::string(what) + ": " + std::strerror(errno); }

bool set_address(int socket, ifreq request, unsigned long what, const char* text) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  if (::inet_pton(AF_INET, text, &address.sin_addr) != 1) return false;
  std::memcpy(&request.ifr_addr, &address, sizeof address);
  return ::ioctl(socket, what, &request) == 0;
}

bool set_up(int socket, ifreq request) {
  if (::ioctl(socket, SIOCGIFFLAGS, &request) != 0) return false;
  request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP);
  return ::ioctl(socket, SIOCSIFFLAGS, &request) == 0;
}

ifreq device_named(const char* name) {
  ifreq request{};
  std::strncpy(request.ifr_name, name, IFNAMSIZ - 1);
  return request;
}

/// Message of rtnetlink(7), built attribute by attribute.
class RouteMessage {
 public:
  template <class Body>
  RouteMessage(std::uint16_t type, const Body& body) {
    header_.nlmsg_type = type;
    header_.nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
    if (type == RTM_NEWROUTE) header_.nlmsg_flags |= NLM_F_CREATE | NLM_F_REPLACE;
    put(&body, sizeof body);
  }
  void attribute(std::uint16_t type, const void* data, std::size_t size) {
    const rtattr head{static_cast<std::uint16_t>(RTA_LENGTH(size)), type};
    put(&head, sizeof head);
    put(data, size);
  }
  /// Sends the message. Returns false with errno set on failure.
  [[nodiscard]] bool send() {
    const Descriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
    header_.nlmsg_len = static_cast<std::uint32_t>(sizeof header_ + body_.size());
    std::vector<std::byte> all(sizeof header_);
    std::memcpy(all.data(), &header_, sizeof header_);
    all.insert(all.end(), body_.begin(), body_.end());
    struct {
      nlmsghdr header;
      nlmsgerr error;
      std::array<std::byte, 1024> request;
    } answer{};
    if (::send(socket.get(), all.data(), all.size(), 0) < 0 ||
        ::recv(socket.get(), &answer, sizeof answer, 0) < static_cast<ssize_t>(NLMSG_LENGTH(sizeof answer.error.error)))
      return false;
    errno = -answer.error.error;
    return answer.header.nlmsg_type == NLMSG_ERROR && answer.error.error == 0;
  }

 private:
  void put(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    body_.insert(body_.end(), bytes, bytes + size);
    body_.resize(NLMSG_ALIGN(body_.size()));
  }

  nlmsghdr header_{};
  std::vector<std::byte> body_;
};

// Sets the congestion control by the route, because the namespace's sysctl only allows values that the whole machine
// permits.
bool set_congestion_control(const char* device, const char* address, const std::string& name) {
  rtmsg route{};
  route.rtm_family = AF_INET;
  route.rtm_dst_len = kNetworkBits;
  route.rtm_table = RT_TABLE_MAIN;
  route.rtm_protocol = RTPROT_KERNEL;
  route.rtm_scope = RT_SCOPE_LINK;
  route.rtm_type = RTN_UNICAST;
  in_addr own{}, network{};
  if (::inet_pton(AF_INET, address, &own) != 1) return false;
  network.s_addr = own.s_addr & htonl(~std::uint32_t{0} << (32 - kNetworkBits));
  const auto index = static_cast<int>(::if_nametoindex(device));
  const rtattr algorithm{static_cast<std::uint16_t>(RTA_LENGTH(name.size() + 1)), RTAX_CC_ALGO};
  std::vector<char> metrics(sizeof algorithm);
  std::memcpy(metrics.data(), &algorithm, sizeof algorithm);
  metrics.insert(metrics.end(), name.c_str(), name.c_str() + name.size() + 1);
  RouteMessage message(RTM_NEWROUTE, route);
  message.attribute(RTA_DST, &network, sizeof network);
  message.attribute(RTA_OIF, &index, sizeof index);
  message.attribute(RTA_PREFSRC, &own, sizeof own);
  message.attribute(RTA_METRICS, metrics.data(), metrics.size());
  return message.send();
}

// Uses rtnetlink, because only root of the whole machine may use the ioctl.
bool set_device_queue(const char* device, std::uint32_t packets) {
  ifinfomsg link{};
  link.ifi_family = AF_UNSPEC;
  link.ifi_index = static_cast<int>(::if_nametoindex(device));
  RouteMessage message(RTM_NEWLINK, link);
  message.attribute(IFLA_TXQLEN, &packets, sizeof packets);
  return message.send();
}

// Makes a network namespace for the calling thread, with a TUN device and a route to the other host.
std::variant<Descriptor, std::string> enter_host(const char* address, const std::string& congestion_control) {
  if (::unshare(CLONE_NEWNET) != 0)
    return failed("no network namespace of its own (it needs root, or to be started by `unshare -r`)");
  Descriptor tun(::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (tun.get() < 0) return failed("/dev/net/tun");
  ifreq device = device_named(kDevice);
  device.ifr_flags = IFF_TUN | IFF_NO_PI;
  if (::ioctl(tun.get(), TUNSETIFF, &device) != 0) return failed("no TUN device");
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  device = device_named(kDevice);
  if (!set_address(socket.get(), device, SIOCSIFADDR, address) ||
      !set_address(socket.get(), device, SIOCSIFNETMASK, "255.255.255.0"))
    return failed("the TUN device takes no address");
  device.ifr_mtu = kMtu;
  if (::ioctl(socket.get(), SIOCSIFMTU, &device) != 0) return failed("the TUN device takes no MTU");
  if (!set_device_queue(kDevice, kDeviceQueue)) return failed("the TUN device takes no queue length");
  // The device's network includes the route to the other host.
  if (!set_up(socket.get(), device_named("lo")) || !set_up(socket.get(), device_named(kDevice)))
    return failed("a network device does not come up");
  if (!set_congestion_control(kDevice, address, congestion_control))
    return failed(("TCP's congestion control " + congestion_control).c_str());
  return tun;
}

}  // namespace

struct EmulatedLink::State {
  explicit State(const LinkSpec& spec) : to_client(spec, 2 * spec.seed), to_server(spec, 2 * spec.seed + 1) {}
  ~State() {
    carrier.request_stop();
    const std::uint64_t one = 1;
    if (stop_event.get() >= 0) (void)!::write(stop_event.get(), &one, sizeof one);
  }
  static std::int64_t now() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
  }
  void carry(const std::stop_token& stop);
  void read(int device, LinkDirection& direction);
  void deliver(int device, LinkDirection& direction, bool is_client);
  void set_timer() const;

  HostThread server, client;
  Descriptor server_device, client_device, timer, stop_event;
  mutable std::mutex mutex;  // guards the members below
  LinkDirection to_client, to_server;
  std::int64_t first = 0, worst = 0;
  std::uint64_t late = 0, not_carried = 0;
  std::jthread carrier;  // last: joins before the members that it uses are destroyed
};

void EmulatedLink::State::read(int device, LinkDirection& direction) {
  std::array<std::byte, 2 * kMtu> buffer;
  for (int i = 0; i < kReadAtOnce; ++i) {
    const ssize_t size = ::read(device, buffer.data(), buffer.size());
    if (size <= 0) return;
    // Skip packets of IPv6. It has no addresses here, but sends neighbour discovery.
    if (std::to_integer<int>(buffer[0]) >> 4 != 4) continue;
    direction.offer({buffer.begin(), buffer.begin() + size}, now());
  }
}

void EmulatedLink::State::deliver(int device, LinkDirection& direction, bool is_client) {
  for (auto due = direction.due(); due; due = direction.due()) {
    const std::int64_t at = now();
    const auto packet = direction.take(at);
    if (!packet) return;
    worst = std::max(worst, at - *due);
    late += at - *due > kLate ? 1 : 0;
    if (::write(device, packet->data(), packet->size()) < 0) ++not_carried;
    if (is_client && first == 0) first = at;
  }
}

void EmulatedLink::State::set_timer() const {
  std::optional<std::int64_t> next = to_client.due();
  if (const auto other = to_server.due(); other && (!next || *other < *next)) next = other;
  itimerspec spec{};
  if (next) {
    // The value 0 would disable the timer.
    const std::int64_t at = std::max<std::int64_t>(*next, 1);
    spec.it_value.tv_sec = at / 1'000'000'000;
    spec.it_value.tv_nsec = at % 1'000'000'000;
  }
  ::timerfd_settime(timer.get(), TFD_TIMER_ABSTIME, &spec, nullptr);
}

void EmulatedLink::State::carry(const std::stop_token& stop) {
  // With a real-time priority, if permitted, the thread precedes all computations. Each of its turns is short.
  sched_param priority{};
  priority.sched_priority = 1;
  (void)::sched_setscheduler(0, SCHED_FIFO, &priority);
  std::array<pollfd, 4> waits{{{server_device.get(), POLLIN, 0},
                               {client_device.get(), POLLIN, 0},
                               {timer.get(), POLLIN, 0},
                               {stop_event.get(), POLLIN, 0}}};
  while (!stop.stop_requested()) {
    {
      const std::lock_guard lock(mutex);
      read(server_device.get(), to_client);
      read(client_device.get(), to_server);
      deliver(client_device.get(), to_client, true);
      deliver(server_device.get(), to_server, false);
      set_timer();
    }
    (void)::poll(waits.data(), waits.size(), -1);
    std::uint64_t expired = 0;
    if (waits[2].revents != 0) (void)!::read(timer.get(), &expired, sizeof expired);
  }
}

EmulatedLink::EmulatedLink(std::unique_ptr<State> state) : state_(std::move(state)) {}
EmulatedLink::~EmulatedLink() = default;

std::variant<std::unique_ptr<EmulatedLink>, std::string> EmulatedLink::create(const LinkSpec& spec,
                                                                              const std::string& congestion_control) {
  auto state = std::make_unique<State>(spec);
  std::string problem;
  const auto enter = [&](HostThread& host, const char* address, Descriptor& device) {
    host.run([&] {
      auto entered = enter_host(address, congestion_control);
      if (auto* made = std::get_if<Descriptor>(&entered))
        device = std::move(*made);
      else if (problem.empty())
        problem = std::get<std::string>(entered);
    });
  };
  enter(state->server, kServerAddress, state->server_device);
  enter(state->client, kClientAddress, state->client_device);
  if (!problem.empty()) return problem;
  state->timer = Descriptor(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC));
  state->stop_event = Descriptor(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (state->timer.get() < 0 || state->stop_event.get() < 0) return failed("no timer");
  state->carrier = std::jthread([raw = state.get()](const std::stop_token& stop) { raw->carry(stop); });
  return std::unique_ptr<EmulatedLink>(new EmulatedLink(std::move(state)));
}

void EmulatedLink::on_server(const std::function<void()>& work) { state_->server.run(work); }
void EmulatedLink::on_client(const std::function<void()>& work) { state_->client.run(work); }

std::optional<Clock::time_point> EmulatedLink::first_at_client() const {
  const std::lock_guard lock(state_->mutex);
  if (state_->first == 0) return std::nullopt;
  return Clock::time_point(std::chrono::nanoseconds(state_->first));
}

LinkCounts EmulatedLink::counts() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->to_client.counts(), state_->to_server.counts(), static_cast<double>(state_->worst) / 1e9,
          state_->late, state_->not_carried};
}

}  // namespace gs::bench
