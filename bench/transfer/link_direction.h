#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gs::bench {

/// A link as it is emulated, the same in both directions.
struct LinkSpec {
  double bits_per_second = 1e7;  // of whole IP packets
  double round_trip = 0.02;      // seconds, without queue and serialization; each direction has half
  double loss = 0;               // share of the packets of each direction, data and acknowledgements alike
  double reordered = 0;          // share of packets that come later than they should, and so behind others
  double reorder_delay = 0.004;  // seconds, how much later
  std::uint64_t seed = 1;        // for losses and reordering
};

/// How many bytes wait for the line at most: one bandwidth-delay product, and not less than 32 kB.
[[nodiscard]] std::size_t queue_bytes(const LinkSpec& spec);

/// Counts of one direction of a link.
struct DirectionCounts {
  std::uint64_t packets = 0, bytes = 0;  // offered
  std::uint64_t lost = 0;                // by chance
  std::uint64_t refused = 0;             // the queue was full
  std::uint64_t delivered = 0;
};

/// One direction of a link, over a time that its owner tells: a drop-tail queue, a line that takes its time for every
/// packet, chance, and a delay. Packets that are lost by chance take up the line like all others. Pure: no clock, no
/// I/O.
class LinkDirection {
 public:
  using Nanoseconds = std::int64_t;

  LinkDirection(const LinkSpec& spec, std::uint64_t seed);

  /// A packet comes to the queue. `now` does not go back.
  void offer(std::vector<std::byte> packet, Nanoseconds now);
  /// When the next packet comes out; nothing while none is under way.
  [[nodiscard]] std::optional<Nanoseconds> due() const;
  /// A packet that is due by now.
  [[nodiscard]] std::optional<std::vector<std::byte>> take(Nanoseconds now);
  [[nodiscard]] const DirectionCounts& counts() const { return counts_; }

 private:
  double chance();

  LinkSpec spec_;
  std::size_t queue_bytes_;
  std::uint64_t random_;
  double line_free_ = 0;                                          // nanoseconds
  std::multimap<Nanoseconds, std::vector<std::byte>> under_way_;  // by the time when they come out
  DirectionCounts counts_;
};

/// Checks rate, queue, delay, loss and order over virtual time; what is wrong, or nothing.
[[nodiscard]] std::optional<std::string> test_link_direction();

}  // namespace gs::bench
