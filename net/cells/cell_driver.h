#pragma once

#include "base/noncopyable.h"
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

/// Serves cells on a UDP port with its own thread, the only thread that uses the library. The destructor says goodbye
/// to all clients and waits some milliseconds for the thread.
class CellServerDriver : NonCopyable {
 public:
  /// Starts the server. `port` 0 means any free port. If the secret is all zeros, replaces it by a random secret.
  [[nodiscard]] static std::variant<std::unique_ptr<CellServerDriver>, UdpError> start(
      CellServerOptions options, std::shared_ptr<CellLibrary> library, std::uint16_t port, bool loopback);
  ~CellServerDriver();
  [[nodiscard]] std::uint16_t port() const;
  /// Returns the statistics. Any thread.
  [[nodiscard]] CellServerStatistics statistics() const;

 private:
  struct State;
  explicit CellServerDriver(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Connection to a cell server. Its functions forward to those of CellClient. One thread.
class CellConnection : NonCopyable {
 public:
  virtual ~CellConnection() = default;
  virtual void want(std::size_t slot, CellWish wish) = 0;
  virtual void prefer(std::size_t slot, std::vector<Region> regions, std::vector<ChunkName> chunks) = 0;
  virtual void forget(std::size_t slot, std::vector<ChunkName> chunks) = 0;
  virtual void set_rate(std::uint64_t bits_per_second) = 0;
  /// Returns events and removes them. Stops after about `most_bytes` bytes of data.
  [[nodiscard]] virtual std::vector<CellEvent> poll(std::size_t most_bytes) = 0;
  [[nodiscard]] virtual CellClientStatistics statistics() const = 0;
};

/// Client of cells with its own thread and socket. Call all functions on one thread. Only `poll` returns results. The
/// destructor says goodbye and waits some milliseconds for the thread, or longer while it resolves the host name.
class CellClientDriver final : public CellConnection {
 public:
  /// Starts the client. The client's thread calls `wake` when `poll` has events; `wake` may be empty. If options.nonce
  /// is 0, replaces it by a random number.
  [[nodiscard]] static std::variant<std::unique_ptr<CellClientDriver>, UdpError> start(CellClientOptions options,
                                                                                       std::string host,
                                                                                       std::uint16_t port,
                                                                                       std::function<void()> wake);
  ~CellClientDriver() override;
  void want(std::size_t slot, CellWish wish) override;
  void prefer(std::size_t slot, std::vector<Region> regions, std::vector<ChunkName> chunks) override;
  void forget(std::size_t slot, std::vector<ChunkName> chunks) override;
  void set_rate(std::uint64_t bits_per_second) override;
  [[nodiscard]] std::vector<CellEvent> poll(std::size_t most_bytes) override;
  [[nodiscard]] CellClientStatistics statistics() const override;

 private:
  struct State;
  explicit CellClientDriver(std::unique_ptr<State> state);
  void command(std::function<void(CellClient&, Instant)> what);
  std::unique_ptr<State> state_;
};

}  // namespace gs::net
