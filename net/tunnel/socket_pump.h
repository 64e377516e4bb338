#pragma once

#include "net/base/descriptor.h"
#include "net/base/event_fd.h"
#include "net/tunnel/multiplexer.h"

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <poll.h>

namespace gs::net {

/// Makes two connected sockets, non-blocking and closed in other programs. Returns empty descriptors on failure.
[[nodiscard]] std::pair<Descriptor, Descriptor> socket_pair();

/// Copies bytes between a pipe with a Multiplexer and the sockets of its connections. One thread.
class SocketPump : NonCopyable {
 public:
  using Time = Multiplexer::Time;

  /// Reads the pipe from `in` and writes it to `out`. They must stay open, and become non-blocking.
  SocketPump(int in, int out);

  /// Connects the local end of a connection.
  void add(Multiplexer::ConnectionId id, Descriptor socket) { sockets_[id] = {std::move(socket), false}; }
  [[nodiscard]] std::size_t connections() const { return sockets_.size(); }
  /// Closes the sockets of all connections.
  void drop_all() { sockets_.clear(); }

  /// Waits for at most `most`, until a descriptor is ready or one of `others` is readable. Then copies bytes. Returns
  /// the reason why the pipe is useless; an empty reason means that the other end closed it.
  [[nodiscard]] std::optional<std::string> step(Multiplexer& multiplexer, std::chrono::milliseconds most,
                                                std::vector<pollfd>& others);

 private:
  struct Local {
    Descriptor socket;
    bool ended = false;  // the local end has closed its socket
  };
  [[nodiscard]] std::optional<std::string> read_pipe(Multiplexer& multiplexer);
  [[nodiscard]] std::optional<std::string> write_pipe(Multiplexer& multiplexer) const;
  static void write_socket(Multiplexer& multiplexer, Multiplexer::ConnectionId id, Local& local);
  static void read_socket(Multiplexer& multiplexer, Multiplexer::ConnectionId id, Local& local);
  void close_ended(Multiplexer& multiplexer);

  int in_, out_;
  std::map<Multiplexer::ConnectionId, Local> sockets_;
  Multiplexer::ConnectionId last_read_ = 0;  // connections take turns
};

}  // namespace gs::net
