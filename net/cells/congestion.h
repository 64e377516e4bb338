#pragma once

#include "net/base/token_bucket.h"

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string_view>

namespace gs::net {

// TCP-friendly rate control (RFC 5348): a stream that loses packets sends no
// more than a TCP connection would under the same loss and round trip, averaged
// over seconds; so both share a bottleneck about evenly.

/// Bytes a second that TCP would reach (RFC 5348 3.1, with b = 1 and t_RTO = 4
/// R); infinite without loss.
[[nodiscard]] double tcp_rate(double packet_bytes, double round_trip_seconds, double loss_rate);
/// The loss rate at which TCP would reach so many bytes a second (the inverse,
/// RFC 5348 6.3.1).
[[nodiscard]] double tcp_loss(double packet_bytes, double round_trip_seconds, double rate);

/// Which losses slow a sender down.
enum class CongestionResponse : std::uint8_t {
  equation,     // all: safe on any network
  delay_aware,  // those that came with a queue (see QueueDelay): for links that
                // lose by themselves, such as radio
  reserved,     // none: the granted rate is reserved for us on the whole path
};

/// A response as an operator names it.
struct CongestionName {
  std::string_view name;
  CongestionResponse response = CongestionResponse::equation;
  std::string_view help;  // one line
};
/// All of them, the default first.
[[nodiscard]] std::span<const CongestionName> congestion_names();

/// Tells whether packets are queued on the way, from the time that each took
/// (by two clocks, so only differences count). "Spike" of Cen, Cosman and
/// Voelker, "End-to-end differentiation of congestion and wireless losses",
/// 2003: a queue begins above half of the range of delays that was seen, and
/// ends below a third of it. Ranges below 10 ms are taken for chance: a
/// bottleneck with so short a queue is not noticed.
class QueueDelay {
 public:
  /// Low 32 bits of microseconds.
  void add(std::uint32_t sent, std::uint32_t received);
  [[nodiscard]] bool queued() const { return queued_; }

 private:
  bool any_ = false, queued_ = false;
  std::uint32_t first_ = 0;
  double least_ = 0, most_ = 0;
};

/// The receiver's half: which datagrams are lost, and the rate of loss events
/// (RFC 5348 5). Memory is bounded.
class LossHistory {
 public:
  /// A datagram came. `round_trip` as far as known; `counts`: whether a loss
  /// found now counts as a loss event.
  void arrived(std::uint64_t number, std::uint64_t bytes, Instant now, Instant round_trip, bool counts);
  [[nodiscard]] std::uint64_t next() const { return next_; }
  [[nodiscard]] std::uint64_t received() const { return received_; }
  /// Known to be lost: three later ones came.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  /// Loss events per datagram, 0 to 1.
  [[nodiscard]] double event_rate() const;
  /// Whether a loss event began since this was last asked.
  [[nodiscard]] bool take_new_event();
  /// Bytes a second since this was last asked.
  [[nodiscard]] double take_receive_rate(Instant now);

 private:
  void lose(std::uint64_t number, Instant now, Instant round_trip, bool counts);

  std::uint64_t next_ = 0, received_ = 0, lost_ = 0;
  std::set<std::uint64_t> missing_;
  std::uint64_t event_first_ = 0;  // the first lost datagram of the newest event
  Instant event_start_{};
  bool any_event_ = false, new_event_ = false;
  double mean_packet_ = 1388;
  std::array<double, 8> intervals_{};  // between events, the newest first
  std::size_t interval_count_ = 0;
  std::uint64_t window_bytes_ = 0;
  Instant window_start_{};
  double last_rate_ = 0;
};

/// The sender's half (RFC 5348 4): the allowed rate in bytes a second. Slow
/// start until the first loss; at most twice of what arrived; at most the
/// grant; never less than a datagram per round trip, which RFC 8085 3.1.2
/// allows anyone.
class RateController {
 public:
  RateController() = default;
  /// `round_trip`: the first estimate. Starts with ten datagrams per round
  /// trip, as RFC 6928 lets TCP.
  RateController(CongestionResponse response, double grant, Instant round_trip, Instant now);
  void set_grant(double grant);
  struct Feedback {
    Instant round_trip{};     // a sample
    double loss_rate = 0;     // of loss events
    double receive_rate = 0;  // bytes a second
    bool limited = false;     // we sent less than allowed: what arrived says nothing
  };
  void feedback(const Feedback& feedback, Instant now);
  /// Call at least when `deadline` passes: halves the rate when reports fail to
  /// come.
  void tick(Instant now);
  [[nodiscard]] Instant deadline() const { return silence_; }
  [[nodiscard]] double rate() const { return rate_; }
  [[nodiscard]] Instant round_trip() const { return round_trip_; }

 private:
  [[nodiscard]] double least() const;
  [[nodiscard]] double initial() const;
  void limit();

  CongestionResponse response_ = CongestionResponse::equation;
  double grant_ = 0, rate_ = 0, previous_receive_ = 0;
  Instant round_trip_{100'000}, doubled_{}, silence_{};
  bool sampled_ = false;
};

}  // namespace gs::net
