#pragma once

#include "net/cells/cell_assembly.h"
#include "net/cells/cell_rebuild.h"
#include "net/cells/congestion.h"

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::net {

struct CellClientOptions {
  std::uint64_t nonce = 0;           // random number that distinguishes sessions of the client
  std::uint64_t rate = 10'000'000;   // requested rate, bits per second
  Instant hello_again{250'000};      // retry interval; doubles after eight tries, at most 2 s
  std::size_t most_tries = 16;       // maximum number of tries without an answer, about 15 s
  std::size_t most_reconnects = 60;  // the same after the contact to a server was lost, about two minutes
  Instant contact_lost{3'000'000};   // time without a datagram until the client asks again
  // Maximum bytes of events that the owner has not taken. Further datagrams are dropped.
  std::size_t most_waiting = std::size_t{64} << 20;
  double loss = 0;  // only for drivers: share of received datagrams to drop, 0 to 1, for trials
  std::uint64_t loss_seed = 1;
  AddressSpace reach = AddressSpace::special;  // only for drivers: most private space in which the server may be
  AddressSpaceOf space_of = address_space_of;
};

/// Request of a client for one of its slots.
struct CellWish {
  std::string path;
  std::uint32_t streams = 0xffff;  // bit set of the streams that are sent unasked
  std::uint64_t budget = 0;        // maximum bytes of chunks; 0 means unlimited
  std::uint8_t weight = 1;         // share of the rate, 1 to 255
  std::uint8_t cells = kMaxCells;  // maximum cells of a datagram
  bool repair = false;             // after everything was sent, requests lost chunks again
};

struct CellClientStatistics {
  std::uint64_t datagrams = 0, lost = 0, foreign = 0, refused_for_space = 0, damaged_pdus = 0;
  std::uint64_t bytes = 0;  // bytes of datagrams
  // Received parity datagrams, and data datagrams restored from them. The latter also count as lost.
  std::uint64_t parity = 0, rebuilt = 0;
  double loss_event_rate = 0;
  Instant round_trip{};
  std::uint64_t granted = 0,
                server_rate = 0;  // bits per second; the server reports both
};

/// Requests sources from a server and returns the received data. State machine without I/O and clock. The owner passes
/// it the server's datagrams and sends the datagrams that it returns. One thread. Safe for untrusted datagrams.
class CellClient {
 public:
  static constexpr std::size_t kMostPreferred = std::size_t{1} << 16;

  explicit CellClient(CellClientOptions options);

  /// Requests a source in slot 0 to 7. Replaces the slot's earlier request. An empty path clears the slot.
  void want(std::size_t slot, CellWish wish, Instant now);
  /// Sets preferred parts of a source: at most kMaxRegions regions in its box, and at most kMostPreferred chunks by
  /// name, of any stream. Each report requests the first of these chunks that were not received.
  void prefer(std::size_t slot, std::vector<Region> regions, std::vector<ChunkName> chunks);
  /// Takes received chunks again, if the server sends them again.
  void forget(std::size_t slot, std::span<const ChunkName> chunks);
  void set_rate(std::uint64_t bits_per_second) { options_.rate = bits_per_second; }
  /// Queues a goodbye message. `next` returns it.
  void bye(Instant now);

  void receive(std::span<const std::byte> bytes, Instant now);
  [[nodiscard]] std::optional<std::vector<std::byte>> next(Instant now);
  [[nodiscard]] Instant deadline(Instant now) const;
  /// Returns the events since the previous call.
  [[nodiscard]] std::vector<CellEvent> take_events();
  [[nodiscard]] CellClientStatistics statistics() const;

 private:
  enum class Phase : std::uint8_t { idle, hello, active, over };
  struct Slot {
    enum class State : std::uint8_t { empty, asking, granted } state = State::empty;
    CellWish wish;
    std::uint32_t number = 0;
    Instant ask{};  // time of the next attempt to request
    std::size_t tries = 0;
    std::unique_ptr<CellAssembly> assembly;
    std::vector<Region> regions;
    std::vector<ChunkName> chunks;
    bool ended = false, complete = false;
  };
  void begin(Instant now);
  void fail(std::string text);
  void handle_grant(const GrantMessage& grant, Instant now);
  void handle_refusal(const RefuseMessage& refusal);
  void handle_sync(const SyncMessage& sync, Instant now);
  void handle_bye(const ByeMessage& bye, Instant now);
  void handle_datagram(std::span<const std::byte> bytes, Instant now);
  void handle_cells(const CellDatagram& datagram, std::span<const std::byte> bytes, Instant now);
  void assemble(std::span<const Cell> cells, bool gap, Instant now);
  void handle_rebuilt(std::span<const CellRebuilder::Rebuilt> rebuilt);
  void stamp(std::uint32_t time, Instant now);
  std::optional<std::vector<std::byte>> next_hello(Instant now);
  std::optional<std::vector<std::byte>> next_request(Instant now);
  std::vector<std::byte> report(Instant now);
  static std::vector<ChunkRun> wishes_of(Slot& slot, std::size_t most);
  [[nodiscard]] Instant report_every() const;
  [[nodiscard]] std::size_t most_tries() const { return known_ ? options_.most_reconnects : options_.most_tries; }
  void tell_complete(std::size_t slot);
  [[nodiscard]] bool anything_wanted() const;
  void append(std::vector<CellEvent> made);

  CellClientOptions options_;
  Phase phase_ = Phase::idle;
  std::uint64_t nonce_ = 0, session_ = 0;
  std::optional<CookieMessage> cookie_;
  std::array<Slot, kMaxSlots> slots_;
  std::uint32_t request_number_ = 0, report_number_ = 0;
  std::size_t tries_ = 0;
  Instant hello_at_{}, report_at_{}, heard_{}, cells_at_{};
  LossHistory history_;
  CellRebuilder rebuilder_;
  QueueDelay delay_;
  bool delay_aware_ = false, report_now_ = false;
  bool known_ = false;  // the server has granted a request
  std::uint64_t sync_next_ = 0;
  std::uint32_t echo_ = 0;
  Instant echo_at_{};
  Instant round_trip_{200'000};
  std::deque<std::vector<std::byte>> outbox_;
  struct Early {
    std::vector<std::byte> bytes;
    Instant at{};
  };
  std::vector<Early> early_;  // cells that were received before the grant
  std::vector<CellEvent> events_;
  std::size_t waiting_ = 0;
  CellClientStatistics statistics_;
};

}  // namespace gs::net
