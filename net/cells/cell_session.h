#pragma once

#include "net/cells/cell_contract.h"
#include "net/cells/cell_framing.h"
#include "net/cells/cell_parity.h"
#include "net/cells/congestion.h"

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace gs::net {

/// Session of one client of a cell server: selects the data, their order and their rate. Part of CellServer. No I/O, no
/// clock.
class CellSession {
 public:
  struct Options {
    CongestionResponse response = CongestionResponse::equation;
    double base_loss = 0.3,
           base_failure = 1e-6;  // first pass of the base: maximum probability of failure at a loss of base_loss
    Instant silence{2'000'000};  // time without reports after which sending stops
    bool parity = true;  // sends parity after the base if the client reports losses
  };
  CellSession(const Options& options, std::uint64_t id, std::uint64_t nonce, Instant round_trip, Instant now);

  [[nodiscard]] std::uint64_t id() const { return id_; }
  [[nodiscard]] std::uint64_t nonce() const { return nonce_; }
  [[nodiscard]] Instant last_heard() const { return last_heard_; }
  [[nodiscard]] bool silent(Instant now) const { return now >= last_heard_ + options_.silence; }
  /// Returns the requested rate in bytes per second.
  [[nodiscard]] std::uint64_t wanted() const { return wanted_; }
  [[nodiscard]] std::uint64_t granted() const { return granted_; }
  void set_wanted(std::uint64_t bytes_per_second) { wanted_ = bytes_per_second; }
  void grant(std::uint64_t bytes_per_second, Instant now);

  /// Returns the number of the request in a slot. 0 means that the slot had no request.
  [[nodiscard]] std::uint32_t number(std::size_t slot) const { return slots_[slot].number; }
  /// Puts a source into the slot of a request. `base` encodes the source's base. A null source clears the slot.
  void set(const RequestMessage& request, std::shared_ptr<CellSource> source,
           std::shared_ptr<const ErasureEncoder> base);
  /// Returns the grant for the request in a slot.
  [[nodiscard]] GrantMessage answer(std::size_t slot) const;
  /// Reports whether a slot has a source that no report of the client has mentioned yet.
  [[nodiscard]] bool unknown(std::size_t slot) const { return slots_[slot].source && !slots_[slot].known; }
  void report(const ReportMessage& report, Instant now);

  /// Returns the time of the next datagram of cells. Instant::max() means that no datagram waits.
  [[nodiscard]] Instant ready(Instant now);
  struct Datagram {
    std::vector<std::byte> bytes;
    bool parity = false;
  };
  /// Returns the next datagram of cells. Returns an empty datagram if nothing may be sent now.
  [[nodiscard]] Datagram datagram(Instant now);
  /// Returns the time of the next sync message. `sync` returns the message.
  [[nodiscard]] Instant sync_due(Instant now) const;
  [[nodiscard]] SyncMessage sync(Instant now);

 private:
  struct StreamState {
    std::vector<bool> sent;
    std::array<std::uint32_t, kMaxRegions + 1> cursors{};  // next chunk index by region; last: whole source
  };
  struct Slot {
    std::uint32_t number = 0;
    std::shared_ptr<CellSource> source;
    std::shared_ptr<const ErasureEncoder> base;
    std::uint8_t weight = 1, cells = kMaxCells;
    std::uint32_t streams = 0;
    std::uint64_t budget = 0, bytes = 0;
    bool known = false, base_done = false, ended = false;
    unsigned base_turn = 0;
    std::size_t base_sent = 0, base_first = 0;
    Instant base_next{}, regions_changed{};
    std::vector<StreamState> states;
    std::vector<Region> regions;
    std::deque<ChunkName> wishes;
    std::map<ChunkName, Instant> wished;  // time at which each wish was last fulfilled
    std::optional<ChunkCutter> cutter;
    std::uint64_t last_group = 0;  // after the end: last parity group that may contain data of the slot
    double turn = 0;  // sent bytes divided by weight; the lowest slot is next
  };
  [[nodiscard]] bool base_waits(const Slot& slot) const { return slot.source && !slot.base_done; }
  [[nodiscard]] Instant slot_ready(const Slot& slot, Instant now) const;
  bool start_chunk(Slot& slot, std::size_t number, Instant now);
  std::optional<ChunkName> next_chunk(Slot& slot, Instant now);
  std::optional<ChunkName> next_wish(Slot& slot, Instant now);
  [[nodiscard]] Instant wish_again() const;
  std::optional<ChunkName> next_in(Slot& slot, std::size_t region);
  void put_base(Slot& slot, std::size_t number, Instant now, std::vector<Cell>& cells);
  void put_data(Slot& slot, std::size_t number, Instant now, std::vector<Cell>& cells);
  [[nodiscard]] Datagram encode(const std::vector<Cell>& cells, bool parity, Instant now);
  void report_loss(const ReportMessage& report, Instant now);
  void handle_report(Slot& slot, const SlotReport& report, Instant now);
  void update_rate(Instant now);

  Options options_;
  std::uint64_t id_, nonce_;
  std::array<Slot, kMaxSlots> slots_;
  RateController controller_;
  TokenBucket bucket_;
  ParitySender parity_;
  std::uint64_t wanted_ = 0, granted_ = 0, next_ = 0;
  std::uint32_t last_report_ = 0;
  bool idle_ = true, sync_now_ = true;
  Instant last_heard_, last_sync_{}, last_cells_{};
};

}  // namespace gs::net
