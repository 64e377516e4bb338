#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gs::bench {

/// Properties of an emulated link, equal in both directions.
struct LinkSpec {
  double bits_per_second = 1e7;  // for whole IP packets
  double round_trip = 0.02;      // seconds, without queue and serialization; each direction has half
  double loss = 0;               // share of the packets of each direction, data and acknowledgements alike
  double reordered = 0;          // share of packets that are delayed, and overtaken by others
  double reorder_delay = 0.004;  // the delay in seconds
  std::uint64_t seed = 1;        // for losses and reordering
};

/// Returns the size of the queue: a bandwidth-delay product, at least 32 kB.
[[nodiscard]] std::size_t queue_bytes(const LinkSpec& spec);

/// Counts of one direction of a link.
struct DirectionCounts {
  std::uint64_t packets = 0, bytes = 0;  // offered
  std::uint64_t lost = 0;                // by chance
  std::uint64_t refused = 0;             // the queue was full
  std::uint64_t delivered = 0;
};

/// One direction of a link in simulated time: a drop-tail queue, a line with serialization time, random loss, and a
/// delay. Lost packets occupy the line, too. Uses no clock and no I/O.
class LinkDirection {
 public:
  using Nanoseconds = std::int64_t;

  LinkDirection(const LinkSpec& spec, std::uint64_t seed);

  /// Adds a packet to the queue. `now` never decreases.
  void offer(std::vector<std::byte> packet, Nanoseconds now);
  /// Returns the time of the next delivery, or nullopt without packets.
  [[nodiscard]] std::optional<Nanoseconds> due() const;
  /// Returns a packet that is due.
  [[nodiscard]] std::optional<std::vector<std::byte>> take(Nanoseconds now);
  [[nodiscard]] const DirectionCounts& counts() const { return counts_; }

 private:
  double chance();

  LinkSpec spec_;
  std::size_t queue_bytes_;
  std::uint64_t random_;
  double line_free_ = 0;                                          // nanoseconds
  std::multimap<Nanoseconds, std::vector<std::byte>> under_way_;  // by delivery time
  DirectionCounts counts_;
};

/// Checks rate, queue, delay, loss and order in simulated time. Returns the first error, or nullopt.
[[nodiscard]] std::optional<std::string> test_link_direction();

}  // namespace gs::bench
