#include "net/control/control_server.h"

#include "net/base/descriptor.h"
#include "net/base/event_fd.h"
#include "net/limits/clock.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

namespace gs::net {
namespace {

constexpr std::size_t kReadAtOnce = std::size_t{64} << 10;
constexpr std::size_t kBehind = std::size_t{256} << 10;  // unread bytes above which a client counts as behind
constexpr int kAcceptedAtOnce = 64;
constexpr Instant kFarewell{1'000'000};  // maximum time to send the remaining bytes to a disconnected client
constexpr Instant kNoDescriptors{100'000};  // pause without accepting, after descriptors ran out

struct Listener {
  Descriptor socket;
  ControlProtocol protocol = ControlProtocol::lines;
  std::string path;  // path of a Unix socket
  struct stat about {};
};

std::string error_text() { return std::strerror(errno); }

// Removes the socket that a killed program left at `path`. Does not touch a socket on which a program listens.
std::optional<std::string> make_room(const std::string& path, const sockaddr_un& address) {
  struct stat about {};
  if (::lstat(path.c_str(), &about) != 0) return std::nullopt;
  if (!S_ISSOCK(about.st_mode)) return path + " already exists and is not a socket; it is not replaced";
  const Descriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 || errno != ECONNREFUSED)
    return path + " is the socket of a running program";
  if (::unlink(path.c_str()) != 0) return path + ": " + error_text();
  return std::nullopt;
}

std::variant<Listener, std::string> listen_at_path(const std::string& path) {
  Listener made;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    return path + ": expected a path of 1 to " + std::to_string(sizeof address.sun_path - 1) + " bytes for a socket";
  path.copy(address.sun_path, path.size());
  if (auto problem = make_room(path, address)) return std::move(*problem);
  made.socket = Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  // Set the mode before the socket has a name, so that other users can never connect.
  if (!made.socket || ::fchmod(made.socket.get(), 0600) != 0 ||
      ::bind(made.socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return path + ": " + error_text();
  made.path = path;
  (void)::lstat(path.c_str(), &made.about);
  return made;
}

std::variant<Listener, std::string> listen_at_port(std::uint16_t& port) {
  Listener made;
  made.protocol = ControlProtocol::web_socket;
  made.socket = Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int on = 1;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (!made.socket || ::setsockopt(made.socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      ::bind(made.socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::getsockname(made.socket.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return "port " + std::to_string(port) + ": " + error_text();
  port = ntohs(address.sin_port);
  return made;
}

// State of one client. The server's thread and the owner's thread share it.
struct Mailbox {
  std::deque<std::string> messages;  // messages from the client
  std::size_t bytes = 0;  // bytes in `messages`
  bool ended = false, told = false;  // ended: no more messages follow; told: the owner has this event
  bool gone = false;                 // the connection is closed
  std::deque<std::string> answers;
  std::size_t answer_bytes = 0, unsent_bytes = 0;  // bytes in `answers`; bytes not sent by the server's thread
  bool behind = false, cut_off = false;  // behind: the client has many unread bytes; cut_off: too many
};

struct Peer {
  Peer(Descriptor taken, ControlProtocol protocol, const ControlTerms& terms, std::uint64_t number, Instant now)
      : socket(std::move(taken)), connection(protocol, terms), id(number), deadline(now + terms.limits.admission) {}
  Descriptor socket;
  ControlConnection connection;
  std::uint64_t id;
  Instant deadline;  // end of the time for admission, or for the last bytes to a disconnected client
  bool known = false;  // the client is admitted and has a Mailbox
  bool ended = false;  // the client sends nothing more
  bool paused = false;  // the server does not read until the owner takes messages
  bool leaves = false;  // the client is disconnected; further input is discarded
  bool shut = false;  // everything is sent, and the sending half of the socket is closed
  bool hung_up = false;  // the client does not read any more; unread messages from it may remain
  bool gone = false;
};

}  // namespace

struct ControlServer::State {
  [[nodiscard]] bool is_full(const Mailbox& box) const {
    return box.bytes >= terms.limits.waiting_bytes || box.messages.size() >= terms.limits.waiting_messages;
  }
  void run();
  void take_answers();
  void wait();
  void accept_all(const Listener& listener);
  void make_room();
  void read(Peer& peer);
  void write(Peer& peer);
  void hand_over(Peer& peer);
  void send_away(Peer& peer, WebSocketClose code, const std::string& why);
  void forget(const Peer& peer);
  void tidy();

  ControlTerms terms;
  std::function<void()> wake;
  std::vector<Listener> listeners;
  std::vector<std::uint16_t> ports;
  EventFd bell;
  std::atomic<bool> stopping = false;
  std::atomic<std::size_t> count = 0;
  std::deque<std::unique_ptr<Peer>> peers;  // connected clients, oldest first
  std::uint64_t last_id = 0;
  Instant no_more_until{0};  // after descriptors ran out: time of the next accept
  bool has_news = false;  // `next` got new events after the last wake
  mutable std::mutex mutex;  // guards the members below
  std::map<std::uint64_t, Mailbox> mailboxes;
  std::uint64_t last_served = 0;
  std::thread thread;
};

ControlServer::ControlServer(std::unique_ptr<State> state) : state_(std::move(state)) {
  state_->thread = std::thread([at = state_.get()] { at->run(); });
}

ControlServer::~ControlServer() {
  state_->stopping = true;
  state_->bell.ring();
  state_->thread.join();
  for (const Listener& one : state_->listeners) {
    struct stat about {};
    if (!one.path.empty() && ::lstat(one.path.c_str(), &about) == 0 && about.st_ino == one.about.st_ino &&
        about.st_dev == one.about.st_dev)
      ::unlink(one.path.c_str());
  }
}

std::variant<std::unique_ptr<ControlServer>, std::string> ControlServer::start(ControlServerOptions options,
                                                                               std::function<void()> wake) {
  auto state = std::make_unique<State>();
  state->terms = std::move(options.terms);
  state->wake = std::move(wake);
  state->ports = std::move(options.ports);
  if (state->terms.token.empty()) return "a token is missing";
  if (state->bell.descriptor() < 0) return "cannot create an event descriptor: " + error_text();
  const auto add = [&](std::variant<Listener, std::string>&& made) -> std::optional<std::string> {
    if (auto* problem = std::get_if<std::string>(&made)) return std::move(*problem);
    state->listeners.push_back(std::move(std::get<Listener>(made)));
    return std::nullopt;
  };
  std::optional<std::string> problem;
  for (std::uint16_t& port : state->ports)
    if (!problem) problem = add(listen_at_port(port));
  for (const std::string& path : options.paths)
    if (!problem) problem = add(listen_at_path(path));
  if (!problem && options.ready) problem = options.ready();
  for (const Listener& one : state->listeners)
    if (!problem && ::listen(one.socket.get(), SOMAXCONN) != 0) problem = "cannot accept connections: " + error_text();
  std::unique_ptr<ControlServer> made(new ControlServer(std::move(state)));  // the destructor removes the sockets
  if (problem) return std::move(*problem);
  return made;
}

const std::vector<std::uint16_t>& ControlServer::ports() const { return state_->ports; }
std::size_t ControlServer::connections() const { return state_->count; }

// Functions for the owner -------------------------------------------------------------------------

std::optional<ControlNews> ControlServer::next() {
  ControlNews news;
  bool go_on = false;
  {
    const std::scoped_lock lock(state_->mutex);
    auto& boxes = state_->mailboxes;
    const auto has_news = [](const auto& one) {
      return !one.second.messages.empty() || (one.second.ended && !one.second.told);
    };
    auto found = std::find_if(boxes.upper_bound(state_->last_served), boxes.end(), has_news);
    if (found == boxes.end()) found = std::find_if(boxes.begin(), boxes.end(), has_news);
    if (found == boxes.end()) return std::nullopt;
    Mailbox& box = found->second;
    news.client = state_->last_served = found->first;
    if (!box.messages.empty()) {
      const bool was_full = state_->is_full(box);
      news.message = std::move(box.messages.front());
      box.messages.pop_front();
      box.bytes -= news.message.size();
      go_on = was_full && !state_->is_full(box);
    } else {
      news.left = box.told = go_on = true;
      if (box.gone) boxes.erase(found);
    }
  }
  if (go_on) state_->bell.ring();
  return news;
}

bool ControlServer::send(std::uint64_t client, std::string message) {
  {
    const std::scoped_lock lock(state_->mutex);
    const auto found = state_->mailboxes.find(client);
    if (found == state_->mailboxes.end() || found->second.cut_off || found->second.gone) return false;
    Mailbox& box = found->second;
    const std::size_t unread = box.answer_bytes + box.unsent_bytes;
    box.behind = box.behind || unread + message.size() > kBehind;
    if (unread > 0 && unread + message.size() > state_->terms.limits.outgoing_bytes) {
      box.cut_off = true;
      box.answers.clear();
      box.answer_bytes = 0;
    } else {
      box.answer_bytes += message.size();
      box.answers.push_back(std::move(message));
    }
  }
  state_->bell.ring();
  return true;
}

bool ControlServer::is_behind(std::uint64_t client) const {
  const std::scoped_lock lock(state_->mutex);
  const auto found = state_->mailboxes.find(client);
  return found != state_->mailboxes.end() && found->second.behind;
}

// Functions of the server's thread -------------------------------------------------------------------

void ControlServer::State::run() {
  while (!stopping) {
    bell.still();
    take_answers();
    tidy();  // queues the reasons for disconnected clients
    for (const auto& peer : peers)
      if (!peer->gone) write(*peer);
    tidy();
    if (std::exchange(has_news, false) && wake) wake();
    wait();
  }
  take_answers();  // sends the answers to the last taken messages
  for (const auto& peer : peers) {
    if (peer->gone) continue;
    peer->connection.close(WebSocketClose::going_away, "the program is ending");
    write(*peer);
  }
}

void ControlServer::State::take_answers() {
  for (const auto& one : peers) {
    Peer& peer = *one;
    if (!peer.known || peer.gone) continue;
    std::deque<std::string> answers;
    bool told = false, cut_off = false;
    {
      const std::scoped_lock lock(mutex);
      Mailbox& box = mailboxes.at(peer.id);
      answers.swap(box.answers);
      box.unsent_bytes += std::exchange(box.answer_bytes, 0);
      peer.paused = is_full(box);
      told = box.told;
      cut_off = box.cut_off;
    }
    for (const std::string& answer : answers) peer.connection.send(answer);
    if (cut_off || peer.connection.outgoing().size() > terms.limits.outgoing_bytes + kReadAtOnce) {
      peer.gone = true;  // a client that does not read would not read a reason
    } else if (told) {
      send_away(peer, WebSocketClose::normal, "");
    }
  }
}

void ControlServer::State::wait() {
  std::vector<pollfd> watched;
  watched.push_back({bell.descriptor(), POLLIN, 0});
  const Instant now = clock_now();
  Instant until = no_more_until > now ? no_more_until : Instant::max();
  for (const Listener& one : listeners)
    watched.push_back({one.socket.get(), static_cast<short>(no_more_until > now ? 0 : POLLIN), 0});
  const std::size_t first = watched.size();
  for (const auto& peer : peers) {
    const bool reads = (!peer->ended && !peer->paused) || (peer->leaves && !peer->ended);
    const bool writes = !peer->connection.outgoing().empty();
    const bool waits = peer->hung_up && peer->paused;
    watched.push_back(
        {waits ? -1 : peer->socket.get(), static_cast<short>((reads ? POLLIN : 0) | (writes ? POLLOUT : 0)), 0});
    if (!peer->known || peer->leaves) until = std::min(until, peer->deadline);
  }
  const std::size_t count_of_peers = peers.size();
  int timeout = -1;
  if (until != Instant::max()) {
    const auto milliseconds = std::chrono::ceil<std::chrono::milliseconds>(std::max(until - now, Instant(0)));
    timeout = static_cast<int>(std::min<std::int64_t>(milliseconds.count(), 60'000));
  }
  if (::poll(watched.data(), watched.size(), timeout) < 0) return;
  for (std::size_t i = 0; i < count_of_peers; ++i) {
    const short events = watched[first + i].revents;
    if ((events & POLLIN) != 0) read(*peers[i]);
    if ((events & (POLLERR | POLLHUP | POLLNVAL)) == 0 || (events & POLLIN) != 0) continue;
    // The client has closed its socket. If reading is paused, read its remaining messages later.
    (peers[i]->paused && !peers[i]->ended ? peers[i]->hung_up : peers[i]->gone) = true;
  }
  for (std::size_t i = 0; i < listeners.size(); ++i)
    if ((watched[1 + i].revents & POLLIN) != 0) accept_all(listeners[i]);
}

void ControlServer::State::accept_all(const Listener& listener) {
  for (int i = 0; i < kAcceptedAtOnce; ++i) {
    Descriptor socket(::accept4(listener.socket.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!socket) {
      if (errno == EMFILE || errno == ENFILE || errno == ENOMEM || errno == ENOBUFS)
        no_more_until = clock_now() + kNoDescriptors;
      return;
    }
    const int on = 1;
    if (listener.protocol == ControlProtocol::web_socket)
      (void)::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    make_room();
    peers.push_back(std::make_unique<Peer>(std::move(socket), listener.protocol, terms, ++last_id, clock_now()));
  }
}

// Removes the oldest clients without admission to make room for new clients.
void ControlServer::State::make_room() {
  std::size_t strangers = 0;
  Peer* oldest = nullptr;
  for (const auto& peer : peers) {
    if (peer->known || peer->gone) continue;
    ++strangers;
    if (!oldest) oldest = peer.get();
  }
  if (oldest && strangers >= terms.limits.strangers) oldest->gone = true;
  tidy();
}

void ControlServer::State::read(Peer& peer) {
  std::array<char, kReadAtOnce> bytes;
  const ssize_t got = ::recv(peer.socket.get(), bytes.data(), bytes.size(), 0);
  if (got < 0) {
    if (errno != EAGAIN && errno != EINTR) peer.gone = true;
    return;
  }
  if (got == 0) {
    peer.ended = true;
    if (!peer.known || peer.leaves) peer.gone = peer.connection.outgoing().empty() || peer.leaves;
  } else if (!peer.leaves) {
    peer.connection.receive({bytes.data(), static_cast<std::size_t>(got)});
  }
  if (!peer.gone) hand_over(peer);
}

void ControlServer::State::hand_over(Peer& peer) {
  if (!peer.known && peer.connection.is_admitted()) {
    const auto known = std::count_if(peers.begin(), peers.end(), [](const auto& one) { return one->known; });
    if (static_cast<std::size_t>(known) >= terms.limits.clients)
      return send_away(peer, WebSocketClose::try_again_later,
                       "there are " + std::to_string(terms.limits.clients) + " clients already");
    peer.known = true;
    const std::scoped_lock lock(mutex);
    mailboxes[peer.id];
  }
  if (peer.known) {
    std::vector<std::string> messages = peer.connection.take_messages();
    const bool ends = peer.ended || peer.connection.is_closing();
    const std::scoped_lock lock(mutex);
    Mailbox& box = mailboxes.at(peer.id);
    has_news = has_news || !messages.empty() || (ends && !box.ended);
    for (std::string& message : messages) {
      box.bytes += message.size();
      box.messages.push_back(std::move(message));
    }
    box.ended = box.ended || ends;
    peer.paused = is_full(box);
  }
  if (peer.connection.is_closing()) send_away(peer, WebSocketClose::normal, "");
}

void ControlServer::State::write(Peer& peer) {
  while (!peer.connection.outgoing().empty()) {
    const std::string_view bytes = peer.connection.outgoing();
    const ssize_t sent = ::send(peer.socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) {
      if (errno == EINTR) continue;
      if (errno != EAGAIN) peer.gone = true;
      break;
    }
    peer.connection.sent(static_cast<std::size_t>(sent));
  }
  if (peer.known) {
    const std::scoped_lock lock(mutex);
    Mailbox& box = mailboxes.at(peer.id);
    box.unsent_bytes = peer.connection.outgoing().size();
    if (box.behind && box.answer_bytes + box.unsent_bytes <= kBehind / 2) {
      box.behind = false;
      has_news = true;
    }
  }
  if (peer.connection.outgoing().empty() && peer.leaves && !std::exchange(peer.shut, true)) {
    // Close only the sending half: closing with unread input would discard the last answer (RFC 9293 3.6.1).
    (void)::shutdown(peer.socket.get(), SHUT_WR);
    if (peer.ended) peer.gone = true;
  }
}

void ControlServer::State::send_away(Peer& peer, WebSocketClose code, const std::string& why) {
  peer.connection.close(code, why);
  if (!std::exchange(peer.leaves, true)) peer.deadline = clock_now() + kFarewell;
}

void ControlServer::State::forget(const Peer& peer) {
  if (!peer.known) return;
  const std::scoped_lock lock(mutex);
  const auto box = mailboxes.find(peer.id);
  box->second.gone = box->second.ended = true;
  box->second.answers.clear();
  if (box->second.told) {
    mailboxes.erase(box);
  } else {
    has_news = true;
  }
}

void ControlServer::State::tidy() {
  const Instant now = clock_now();
  std::erase_if(peers, [&](const std::unique_ptr<Peer>& peer) {
    if (!peer->gone && (!peer->known || peer->leaves) && peer->deadline <= now) {
      if (peer->leaves) {
        peer->gone = true;
      } else {
        send_away(*peer, WebSocketClose::policy, "the token was not received in time");
      }
    }
    if (peer->gone) forget(*peer);
    return peer->gone;
  });
  count = peers.size();
}

}  // namespace gs::net
