#pragma once

#include "base/noncopyable.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace gs::net {

/// Carrier of several byte connections over one pipe, as a state machine without descriptors. One thread.
class Multiplexer : NonCopyable {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using ConnectionId = std::uint32_t;

  virtual ~Multiplexer() = default;

  /// Takes bytes from the pipe. Returns the error after which the pipe is useless, or nullopt.
  [[nodiscard]] virtual std::optional<std::string> receive(std::span<const std::byte> bytes, Time now) = 0;
  /// Returns bytes for the pipe. sent() removes the first ones.
  [[nodiscard]] virtual std::span<const std::byte> outgoing() const = 0;
  virtual void sent(std::size_t bytes) = 0;
  /// Does what is due. Returns an error as receive() does.
  [[nodiscard]] virtual std::optional<std::string> step(Time now) = 0;
  /// Returns the time of the next necessary step(); nullopt if there is none.
  [[nodiscard]] virtual std::optional<Time> deadline() const = 0;

  /// Opens a connection to the other end. Returns 0 if it is not possible.
  [[nodiscard]] virtual ConnectionId open() = 0;
  /// Returns the number of bytes that send() accepts for the connection now.
  [[nodiscard]] virtual std::size_t room(ConnectionId id) const = 0;
  virtual void send(ConnectionId id, std::span<const std::byte> bytes) = 0;
  /// Returns received bytes of the connection. took() removes the first ones.
  [[nodiscard]] virtual std::span<const std::byte> received(ConnectionId id) const = 0;
  virtual void took(ConnectionId id, std::size_t bytes) = 0;
  /// Reports whether no bytes follow those of received().
  [[nodiscard]] virtual bool ended(ConnectionId id) const = 0;
  /// Ends a connection, because its local end was closed or has taken all bytes. No more bytes are taken from it.
  virtual void close(ConnectionId id) = 0;
};

}  // namespace gs::net
