#include "net/tunnel/socket_pump.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gs::net {
namespace {

constexpr std::size_t kBlock = std::size_t{64} << 10;

bool is_passing(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

void do_not_block(int descriptor) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags >= 0) (void)::fcntl(descriptor, F_SETFL, flags | O_NONBLOCK);
}

}  // namespace

std::pair<Descriptor, Descriptor> socket_pair() {
  int both[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, both) != 0) return {};
  return {Descriptor(both[0]), Descriptor(both[1])};
}

SocketPump::SocketPump(int in, int out) : in_(in), out_(out) {
  do_not_block(in);
  do_not_block(out);
}

std::optional<std::string> SocketPump::step(Multiplexer& multiplexer, std::chrono::milliseconds most,
                                            std::vector<pollfd>& others) {
  const Time begin = std::chrono::steady_clock::now();
  if (const auto deadline = multiplexer.deadline())
    most =
        std::clamp(std::chrono::ceil<std::chrono::milliseconds>(*deadline - begin), std::chrono::milliseconds(0), most);
  std::vector<pollfd> waits = others;
  waits.push_back({in_, POLLIN, 0});
  const bool writes = !multiplexer.outgoing().empty();
  waits.push_back({writes ? out_ : -1, POLLOUT, 0});
  for (const auto& [id, local] : sockets_) {
    const int events = (multiplexer.received(id).empty() ? 0 : POLLOUT) | (multiplexer.room(id) > 0 ? POLLIN : 0);
    // Without a wanted event, a closed socket would end each wait at once.
    waits.push_back({events != 0 ? local.socket.get() : -1, static_cast<short>(events), 0});
  }
  (void)::poll(waits.data(), waits.size(), static_cast<int>(most.count()));
  std::copy_n(waits.begin(), others.size(), others.begin());
  if (auto problem = read_pipe(multiplexer)) return problem;
  if (auto problem = multiplexer.step(std::chrono::steady_clock::now())) return problem;
  for (auto& [id, local] : sockets_) write_socket(multiplexer, id, local);
  // Reading begins after the connection that was read last.
  auto at = sockets_.upper_bound(last_read_);
  for (std::size_t i = 0; i < sockets_.size(); ++i, ++at) {
    if (at == sockets_.end()) at = sockets_.begin();
    if (multiplexer.room(at->first) > 0) last_read_ = at->first;
    read_socket(multiplexer, at->first, at->second);
  }
  close_ended(multiplexer);
  return write_pipe(multiplexer);
}

std::optional<std::string> SocketPump::read_pipe(Multiplexer& multiplexer) {
  std::array<std::byte, kBlock> block;
  // A bounded number of blocks, so that the sockets get their turn.
  for (int i = 0; i < 4; ++i) {
    const ssize_t got = ::read(in_, block.data(), block.size());
    if (got == 0) return std::string();
    if (got < 0) return is_passing(errno) ? std::nullopt : std::optional<std::string>(std::strerror(errno));
    const auto bytes = std::span(block).first(static_cast<std::size_t>(got));
    if (auto problem = multiplexer.receive(bytes, std::chrono::steady_clock::now())) return problem;
  }
  return std::nullopt;
}

std::optional<std::string> SocketPump::write_pipe(Multiplexer& multiplexer) const {
  for (;;) {
    const auto bytes = multiplexer.outgoing();
    if (bytes.empty()) return std::nullopt;
    const ssize_t put = ::write(out_, bytes.data(), bytes.size());
    if (put < 0 && errno == EPIPE) return std::string();
    if (put < 0) return is_passing(errno) ? std::nullopt : std::optional<std::string>(std::strerror(errno));
    multiplexer.sent(static_cast<std::size_t>(put));
  }
}

void SocketPump::write_socket(Multiplexer& multiplexer, Multiplexer::ConnectionId id, Local& local) {
  while (!local.ended) {
    const auto bytes = multiplexer.received(id);
    if (bytes.empty()) return;
    const ssize_t put = ::send(local.socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (put < 0) {
      local.ended = !is_passing(errno);
      return;
    }
    multiplexer.took(id, static_cast<std::size_t>(put));
  }
}

void SocketPump::read_socket(Multiplexer& multiplexer, Multiplexer::ConnectionId id, Local& local) {
  if (local.ended) return;
  std::array<std::byte, kBlock> block;
  const std::size_t room = std::min(multiplexer.room(id), block.size());
  if (room == 0) {
    // Without room, only look whether the socket was closed and all of its bytes were read.
    const ssize_t got = ::recv(local.socket.get(), block.data(), 1, MSG_PEEK);
    local.ended = got == 0 || (got < 0 && !is_passing(errno));
    return;
  }
  const ssize_t got = ::recv(local.socket.get(), block.data(), room, 0);
  if (got > 0) multiplexer.send(id, std::span(block).first(static_cast<std::size_t>(got)));
  local.ended = got == 0 || (got < 0 && !is_passing(errno));
}

void SocketPump::close_ended(Multiplexer& multiplexer) {
  std::erase_if(sockets_, [&](const auto& entry) {
    const auto& [id, local] = entry;
    const bool whole = multiplexer.ended(id) && multiplexer.received(id).empty();
    if (!local.ended && !whole) return false;
    multiplexer.close(id);
    return true;
  });
}

}  // namespace gs::net
