#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "net/base/range_set.h"
#include "net/transfer/transport.h"

namespace gs::net {

/// Part of a request. At most one transfer at a time loads it.
struct Fetch {
  ByteRange range;
  std::uint64_t position = 0;  // offset of the next byte to receive
  TransferId transfer = 0;     // 0 means that no transfer runs
  TimePoint not_before{};
  unsigned failures = 0;  // failures after the last progress
  unsigned attempts = 0;
  bool conditional = false;  // only asks the server whether the cached version is still valid
  bool finished = false;
  bool paused = false;
  bool preempted = false;  // paused so that a more urgent transfer can run

  /// State of the current response of a fetch.
  struct Answer {
    std::string redirect;
    AddressSpace space = AddressSpace::global;  // space of the responding host
    std::optional<LoadError> error;
    bool transient = false;
    std::optional<std::int64_t> retry_after;
    std::optional<ResponseHead> not_modified;
    bool whole = false;
    std::optional<std::uint64_t> end;  // end of the body, as an offset in the resource
    std::vector<std::byte> held;       // received bytes that wait until the cached bytes before them are delivered
    std::optional<TransferEnd> held_end;
  } answer;
};

/// Fetches of one request, in the order of their ranges. One thread.
class FetchPlan {
 public:
  /// `cancel` cancels a running transfer. `join_gap` is the gap in bytes below which ranges are joined.
  FetchPlan(const std::function<void(TransferId)>& cancel, std::uint64_t join_gap)
      : cancel_(cancel), join_gap_(join_gap) {}

  [[nodiscard]] std::span<const std::unique_ptr<Fetch>> all() const { return fetches_; }
  /// Adds a fetch for each range of `missing`.
  void add(const RangeSet& missing);
  /// Adds fetches for the bytes of `needed` that no unfinished fetch loads.
  void cover(const RangeSet& needed);
  /// Adds one fetch for `range` that only asks whether the cached version is still valid.
  void add_conditional(ByteRange range);
  [[nodiscard]] bool is_first_unfinished(const Fetch& fetch) const;
  /// Returns the largest number of attempts of a fetch.
  [[nodiscard]] unsigned attempts() const;
  /// Delays all unfinished fetches, and continues their count of attempts.
  void delay(TimePoint not_before, unsigned attempts);

  void stop(Fetch& fetch);
  void stop_all();
  /// Stops and finishes all fetches. Callers may still use them; erase_finished() deletes them.
  void finish_all() { finish_others(nullptr); }
  void finish_others(const Fetch* kept);
  /// Deletes the finished fetches without a transfer.
  void erase_finished();

 private:
  const std::function<void(TransferId)>& cancel_;
  const std::uint64_t join_gap_;
  std::vector<std::unique_ptr<Fetch>> fetches_;
};

}  // namespace gs::net
