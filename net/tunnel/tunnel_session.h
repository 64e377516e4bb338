#pragma once

#include "net/tunnel/multiplexer.h"
#include "net/tunnel/tunnel_frames.h"

#include <map>
#include <vector>

namespace gs::net {

enum class TunnelRole : std::uint8_t { client, server };

/// Properties of one end of a tunnel.
struct TunnelTerms {
  TunnelRole role = TunnelRole::client;
  std::string version;                      // version of this program, for messages of the other end
  std::chrono::milliseconds quiet{20'000};  // silence after which the other end must answer a ping within as long again
  std::size_t connections = 64;             // maximum open connections
};

/// One end of a tunnel: connections as frames, with a window per connection. The client's window grows with the
/// measured rate, so that a cancelled transfer leaves few bytes on a slow line. One thread.
class TunnelSession final : public Multiplexer {
 public:
  TunnelSession(TunnelTerms terms, Time now);

  [[nodiscard]] std::optional<std::string> receive(std::span<const std::byte> bytes, Time now) override;
  [[nodiscard]] std::span<const std::byte> outgoing() const override;
  void sent(std::size_t bytes) override;
  [[nodiscard]] std::optional<std::string> step(Time now) override;
  [[nodiscard]] std::optional<Time> deadline() const override;
  [[nodiscard]] ConnectionId open() override;
  [[nodiscard]] std::size_t room(ConnectionId id) const override;
  void send(ConnectionId id, std::span<const std::byte> bytes) override;
  [[nodiscard]] std::span<const std::byte> received(ConnectionId id) const override;
  void took(ConnectionId id, std::size_t bytes) override;
  [[nodiscard]] bool ended(ConnectionId id) const override;
  void close(ConnectionId id) override;

  /// Reports whether the hello of the other end was received.
  [[nodiscard]] bool ready() const { return hello_.has_value(); }
  /// Reports whether the mark of the other end was received.
  [[nodiscard]] bool marked() const { return reader_.marked(); }
  [[nodiscard]] const TunnelHello& hello() const { return *hello_; }
  /// Returns connections that the other end has opened since the last call. For the server.
  [[nodiscard]] std::vector<ConnectionId> take_opened();
  [[nodiscard]] std::size_t connections() const { return connections_.size(); }
  /// Returns the bytes that a connection may receive before it must grant more.
  [[nodiscard]] std::size_t window() const { return window_; }

 private:
  struct Connection {
    std::uint64_t send_credit = 0, receive_credit = 0;
    std::vector<std::byte> in;
    std::size_t in_begin = 0;
    bool peer_ended = false;
  };
  [[nodiscard]] std::optional<std::string> take(const TunnelFrame& frame, Time now);
  [[nodiscard]] std::optional<std::string> take_hello(const TunnelFrame& frame);
  [[nodiscard]] std::optional<std::string> take_of_connection(const TunnelFrame& frame, Time now);
  void take_pong(const TunnelFrame& frame, Time now);
  void measure(std::size_t bytes, Time now);
  void grant(ConnectionId id, Connection& connection);
  void ping(Time now);

  TunnelTerms terms_;
  TunnelFrameReader reader_;
  std::vector<std::byte> out_;
  std::size_t out_begin_ = 0;
  std::optional<TunnelHello> hello_;
  std::map<ConnectionId, Connection> connections_;
  std::vector<ConnectionId> opened_;
  ConnectionId last_id_ = 0;
  std::size_t window_;
  Time heard_;                  // time of the last received bytes
  std::optional<Time> pinged_;  // time of the ping that no pong has answered
  std::uint32_t last_ping_ = 0;
  std::uint64_t probed_bytes_ = 0;  // data received since that ping
  double best_rate_ = 0;            // bytes per second
};

}  // namespace gs::net
