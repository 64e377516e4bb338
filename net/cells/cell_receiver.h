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
  std::uint64_t nonce = 0;                           // random
  std::uint64_t rate = 10'000'000;                   // bits a second, wanted at first
  Instant hello_again{250'000};                      // after eight tries it doubles, up to 2 s
  std::size_t most_tries = 16;                       // without any answer
  Instant contact_lost{3'000'000};                   // after so long without a datagram the client asks anew
  std::size_t most_waiting = std::size_t{64} << 20;  // bytes of events that the owner has not
                                                     // taken; what comes then is lost
  double loss = 0;                                   // of the driver: this share of what comes is dropped, for trials
  std::uint64_t loss_seed = 1;
  AddressSpace reach = AddressSpace::special;  // of the driver: the most private space in which the server may be
  AddressSpaceOf space_of = address_space_of;
};

/// What a client wants in one of its slots.
struct CellWish {
  std::string path;
  std::uint32_t streams = 0xffff;   // bit per stream
  std::uint64_t budget = 0;         // bytes; 0: no limit
  std::uint8_t weight = 1;          // share of the rate
  std::uint8_t cells = kMostCells;  // of a datagram
  bool repair = false;              // asks again for what was lost, once all was sent
};

struct CellClientStatistics {
  std::uint64_t datagrams = 0, lost = 0, foreign = 0, refused_for_space = 0, damaged_pdus = 0;
  std::uint64_t bytes = 0;                // of datagrams
  std::uint64_t parity = 0, rebuilt = 0;  // datagrams of parity; of data, rebuilt from them (those count as lost)
  double loss_event_rate = 0;
  Instant round_trip{};
  std::uint64_t granted = 0,
                server_rate = 0;  // bits a second, as the server says
};

/// Asks a server for sources and hands out what comes. A state machine without
/// I/O and clock: feed it the datagrams of the one server, ask it for those to
/// send and when to ask again. One thread; safe for untrusted datagrams.
class CellClient {
 public:
  explicit CellClient(CellClientOptions options);

  /// Asks for something in slot 0 to 7, in place of what was there.
  void want(std::size_t slot, CellWish wish, Instant now);
  /// Nothing more in this slot.
  void drop(std::size_t slot, Instant now);
  /// What comes first: regions (of the source's box), or chunks by name, also
  /// such as were sent before. The next report says it; at most kMostRegions
  /// and kMostWishes.
  void prefer(std::size_t slot, std::vector<Region> regions, std::vector<ChunkName> chunks);
  void set_rate(std::uint64_t bits_per_second) { options_.rate = bits_per_second; }
  /// Says goodbye; `next` hands out the word.
  void bye(Instant now);

  void receive(std::span<const std::byte> bytes, Instant now);
  [[nodiscard]] std::optional<std::vector<std::byte>> next(Instant now);
  [[nodiscard]] Instant deadline(Instant now) const;
  /// What happened since this was last asked.
  [[nodiscard]] std::vector<CellEvent> take_events();
  /// The share of a slot's chunks' bytes that came is for the owner to know:
  /// this is how many.
  [[nodiscard]] std::uint64_t bytes(std::size_t slot) const;
  [[nodiscard]] CellClientStatistics statistics() const;

 private:
  enum class Phase : std::uint8_t { idle, hello, active, over };
  struct Slot {
    enum class State : std::uint8_t { empty, asking, granted } state = State::empty;
    CellWish wish;
    std::uint32_t number = 0;
    Instant ask{};  // again
    std::size_t tries = 0;
    std::unique_ptr<CellAssembly> assembly;
    std::vector<Region> regions;
    std::vector<ChunkName> chunks;
    bool ended = false, complete = false;
  };
  void begin(Instant now);
  void fail(std::string text);
  void take_grant(const GrantMessage& grant, Instant now);
  void take_refusal(const RefuseMessage& refusal);
  void take_sync(const SyncMessage& sync, Instant now);
  void take_bye(const ByeMessage& bye, Instant now);
  void take_datagram(std::span<const std::byte> bytes, Instant now);
  void take_cells(const CellDatagram& datagram, std::span<const std::byte> bytes, Instant now);
  void assemble(std::span<const Cell> cells, bool gap, Instant now);
  void take_rebuilt(std::span<const CellRebuilder::Rebuilt> rebuilt);
  void stamp(std::uint32_t time, Instant now);
  std::optional<std::vector<std::byte>> next_hello(Instant now);
  std::optional<std::vector<std::byte>> next_request(Instant now);
  std::vector<std::byte> report(Instant now);
  [[nodiscard]] Instant report_every() const;
  void tell_complete(std::size_t slot);
  [[nodiscard]] bool anything_wanted() const;
  void append(std::vector<CellEvent> made);

  CellClientOptions options_;
  Phase phase_ = Phase::idle;
  std::uint64_t nonce_ = 0, session_ = 0;
  std::optional<CookieMessage> cookie_;
  std::array<Slot, kMostSlots> slots_;
  std::uint32_t request_number_ = 0, report_number_ = 0;
  std::size_t tries_ = 0;
  Instant hello_at_{}, report_at_{}, heard_{}, cells_at_{};
  LossHistory history_;
  CellRebuilder rebuilder_;
  QueueDelay delay_;
  bool delay_aware_ = false, report_now_ = false;
  std::uint64_t sync_next_ = 0;
  std::uint32_t echo_ = 0;
  Instant echo_at_{};
  Instant round_trip_{200'000};
  std::deque<std::vector<std::byte>> outbox_;
  struct Early {
    std::vector<std::byte> bytes;
    Instant at{};
  };
  std::vector<Early> early_;  // cells that overtook the grant
  std::vector<CellEvent> events_;
  std::size_t waiting_ = 0;
  CellClientStatistics statistics_;
};

}  // namespace gs::net
