#pragma once

#include "net/limits/token_bucket.h"

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string_view>

namespace gs::net {

// TCP-friendly rate control (RFC 5348). Averaged over seconds, a stream with losses sends no more than a TCP connection
// with equal loss and round trip. So both share a bottleneck about evenly.

/// Returns the rate of TCP in bytes per second (RFC 5348 3.1, with b = 1 and t_RTO = 4 R). Returns infinity if
/// `loss_rate` is 0.
[[nodiscard]] double tcp_rate(double packet_bytes, double round_trip_seconds, double loss_rate);
/// Returns the loss rate at which TCP has a rate in bytes per second. Inverse of tcp_rate() (RFC 5348 6.3.1).
[[nodiscard]] double tcp_loss(double packet_bytes, double round_trip_seconds, double rate);

/// Kinds of losses that reduce the rate of a sender.
enum class CongestionResponse : std::uint8_t {
  equation,     // all losses: safe on any network
  delay_aware,  // losses while a queue is observed (QueueDelay): for links with random losses, such as radio
  reserved,  // no losses: for a rate that is reserved on the whole path
};

/// Name of a CongestionResponse, for operators.
struct CongestionName {
  std::string_view name;
  CongestionResponse response = CongestionResponse::equation;
  std::string_view help;  // one line of help
};
/// Returns all responses. The default is the first.
[[nodiscard]] std::span<const CongestionName> congestion_names();

/// Detects queues in the network by the delay of each packet. The two clocks may differ, so only changes of the delay
/// count. Implements "Spike" of Cen, Cosman and Voelker, "End-to-end differentiation of congestion and wireless
/// losses", 2003.
///
/// A queue begins above half of the observed range of delays and ends below a third of it. Ranges below 10 ms count as
/// noise, so shorter queues are not detected.
class QueueDelay {
 public:
  /// Adds a packet. Both times are microseconds, the low 32 bits.
  void add(std::uint32_t sent, std::uint32_t received);
  [[nodiscard]] bool queued() const { return queued_; }

 private:
  bool any_ = false, queued_ = false;
  std::uint32_t first_ = 0;
  double least_ = 0, most_ = 0;
};

/// Receiver's half of rate control: counts lost datagrams and loss events (RFC 5348 5). Memory is bounded.
class LossHistory {
 public:
  /// Adds a received datagram. `round_trip` is the current estimate. If `counts`, losses that this datagram
  /// proves are loss events.
  void arrived(std::uint64_t number, std::uint64_t bytes, Instant now, Instant round_trip, bool counts);
  [[nodiscard]] std::uint64_t next() const { return next_; }
  [[nodiscard]] std::uint64_t received() const { return received_; }
  /// Returns the number of lost datagrams. A datagram is lost if three later datagrams are received before it.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  /// Returns the loss events per datagram, 0 to 1.
  [[nodiscard]] double event_rate() const;
  /// Reports whether a loss event began after the previous call.
  [[nodiscard]] bool clear_new_event();
  /// Returns the received bytes per second since the previous call.
  [[nodiscard]] double measure_receive_rate(Instant now);

 private:
  void lose(std::uint64_t number, Instant now, Instant round_trip, bool counts);

  std::uint64_t next_ = 0, received_ = 0, lost_ = 0;
  std::set<std::uint64_t> missing_;
  std::uint64_t event_first_ = 0;  // number of the first lost datagram of the newest event
  Instant event_start_{};
  bool any_event_ = false, new_event_ = false;
  double mean_packet_ = 1388;
  std::array<double, 8> intervals_{};  // datagrams between successive events, newest first
  std::size_t interval_count_ = 0;
  std::uint64_t window_bytes_ = 0;
  Instant window_start_{};
  double last_rate_ = 0;
};

/// Sender's half of rate control (RFC 5348 4): the allowed rate in bytes per second. Starts slowly until the first
/// loss. The rate is at most twice the received rate, and at most the grant. It is at least one datagram per round
/// trip, as RFC 8085 3.1.2 allows.
class RateController {
 public:
  RateController() = default;
  /// Starts with ten datagrams per round trip, as in TCP (RFC 6928). `round_trip` is the first estimate.
  RateController(CongestionResponse response, double grant, Instant round_trip, Instant now);
  void set_grant(double grant);
  struct Feedback {
    Instant round_trip{};  // measured round trip
    double loss_rate = 0;  // loss events per datagram
    double receive_rate = 0;  // bytes per second that the receiver got
    bool limited = false;  // the sender used less than the allowed rate, so receive_rate must not limit it
  };
  void feedback(const Feedback& feedback, Instant now);
  /// Halves the rate if no report was received in time. Call it at `deadline` or earlier.
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
