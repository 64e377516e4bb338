#pragma once

#include "net/cells/cell_receiver.h"
#include "net/cells/cell_sender.h"
#include "net/cells/udp.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace gs::net {

/// Serves cells on a port of UDP by a thread of its own. Its destructor says
/// goodbye to all clients and waits for the thread, which takes milliseconds.
/// The library is used on that thread only.
class CellServerDriver {
 public:
  /// `port` 0: any free one. An all-zero secret is replaced by a random one.
  [[nodiscard]] static std::variant<std::unique_ptr<CellServerDriver>, UdpError> start(
      CellServerOptions options, std::shared_ptr<CellLibrary> library, std::uint16_t port, bool loopback);
  ~CellServerDriver();
  CellServerDriver(const CellServerDriver&) = delete;
  CellServerDriver& operator=(const CellServerDriver&) = delete;
  [[nodiscard]] std::uint16_t port() const;
  /// Any thread.
  [[nodiscard]] CellServerStatistics statistics() const;

 private:
  struct State;
  explicit CellServerDriver(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// A client of cells with a thread and a socket of its own. All calls from one
/// thread; results arrive in `poll` only. Its destructor says goodbye and waits
/// for the thread, which takes milliseconds (a look-up of the host's name may
/// make it wait for the name server).
class CellClientDriver {
 public:
  /// `wake` is called from the thread when `poll` would have something; it may
  /// be empty. An options.nonce of 0 is replaced by a random one.
  [[nodiscard]] static std::variant<std::unique_ptr<CellClientDriver>, UdpError> start(CellClientOptions options,
                                                                                       std::string host,
                                                                                       std::uint16_t port,
                                                                                       std::function<void()> wake);
  ~CellClientDriver();
  CellClientDriver(const CellClientDriver&) = delete;
  CellClientDriver& operator=(const CellClientDriver&) = delete;
  /// See CellClient.
  void want(std::size_t slot, CellWish wish);
  void drop(std::size_t slot);
  void prefer(std::size_t slot, std::vector<Region> regions, std::vector<ChunkName> chunks);
  void set_rate(std::uint64_t bits_per_second);
  /// What happened, about `most_bytes` of it at most.
  [[nodiscard]] std::vector<CellEvent> poll(std::size_t most_bytes);
  [[nodiscard]] CellClientStatistics statistics() const;

 private:
  struct State;
  explicit CellClientDriver(std::unique_ptr<State> state);
  void command(std::function<void(CellClient&, Instant)> what);
  std::unique_ptr<State> state_;
};

}  // namespace gs::net
