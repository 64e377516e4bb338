#include "net/cells/congestion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gs::net {
namespace {

constexpr double kPacket = 1388;  // bytes of a typical datagram, with the headers of IP and UDP
constexpr std::size_t kMaxMissing = 1024;
constexpr std::uint64_t kLater = 3;  // number of later datagrams that prove a loss (RFC 5348 5.1)
constexpr std::array<double, 8> kWeights{1, 1, 1, 1, 0.8, 0.6, 0.4, 0.2};
constexpr double kMinQueue = 10'000;  // microseconds; a smaller range of delays is noise
constexpr Instant kShortestTrip{500}, kLongestTrip{5'000'000};
constexpr std::array<CongestionName, 3> kNames{{
    {"equation", CongestionResponse::equation, "slows down at any loss, like TCP; safe on every network"},
    {"delay-aware", CongestionResponse::delay_aware,
     "slows down at losses with a queue; for lossy links such as radio"},
    {"reserved", CongestionResponse::reserved, "keeps the granted rate at any loss; for paths with a reserved rate"},
}};

double seconds(Instant time) { return static_cast<double>(time.count()) * 1e-6; }

}  // namespace

std::span<const CongestionName> congestion_names() { return kNames; }

double tcp_rate(double packet_bytes, double round_trip_seconds, double loss_rate) {
  if (loss_rate <= 0) return std::numeric_limits<double>::infinity();
  const double p = std::min(loss_rate, 1.0), r = round_trip_seconds;
  return packet_bytes / (r * std::sqrt(2 * p / 3) + 4 * r * (3 * std::sqrt(3 * p / 8)) * p * (1 + 32 * p * p));
}

double tcp_loss(double packet_bytes, double round_trip_seconds, double rate) {
  double low = 1e-8, high = 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = std::sqrt(low * high);
    (tcp_rate(packet_bytes, round_trip_seconds, middle) > rate ? low : high) = middle;
  }
  return high;
}

void QueueDelay::add(std::uint32_t sent, std::uint32_t received) {
  const std::uint32_t taken = received - sent;
  if (!any_) {
    any_ = true;
    first_ = taken;
    return;
  }
  const auto delay = static_cast<double>(static_cast<std::int32_t>(taken - first_));
  least_ = std::min(least_, delay);
  most_ = std::max(most_, delay);
  const double range = most_ - least_;
  if (range < kMinQueue)
    queued_ = false;
  else if (delay > least_ + range / 2)
    queued_ = true;
  else if (delay < least_ + range / 3)
    queued_ = false;
}

void LossHistory::arrived(std::uint64_t number, std::uint64_t bytes, Instant now, Instant round_trip, bool counts) {
  ++received_;
  window_bytes_ += bytes;
  mean_packet_ += (static_cast<double>(bytes) - mean_packet_) / 16;
  if (number < next_) {
    missing_.erase(number);
    return;
  }
  const std::uint64_t gap = number - next_;
  // After a long silence, record single losses only for the newest missing datagrams.
  const std::uint64_t skipped = gap > kMaxMissing ? gap - kMaxMissing : 0;
  if (skipped > 0) {
    lost_ += missing_.size() + skipped;
    missing_.clear();
    lose(next_, now, round_trip, counts);
    --lost_;
  }
  for (std::uint64_t i = next_ + skipped; i < number; ++i) missing_.insert(missing_.end(), i);
  next_ = number + 1;
  while (!missing_.empty() && (*missing_.begin() + kLater < next_ || missing_.size() > kMaxMissing)) {
    lose(*missing_.begin(), now, round_trip, counts);
    missing_.erase(missing_.begin());
  }
}

void LossHistory::lose(std::uint64_t number, Instant now, Instant round_trip, bool counts) {
  ++lost_;
  if (!counts || (any_event_ && now < event_start_ + round_trip)) return;
  if (any_event_) {
    std::copy_backward(intervals_.begin(), intervals_.end() - 1, intervals_.end());
    intervals_[0] = static_cast<double>(number - std::min(event_first_, number));
    interval_count_ = std::min(interval_count_ + 1, intervals_.size());
  } else {
    // Begin with the loss interval at which TCP would have the rate so far (RFC 5348 6.3.1).
    const double span = std::max(seconds(now - window_start_), 1e-3);
    const double rate = std::max(last_rate_, static_cast<double>(window_bytes_) / span);
    intervals_[0] = 1 / tcp_loss(mean_packet_, std::max(seconds(round_trip), 1e-3), std::max(rate, 1.0));
    interval_count_ = 1;
  }
  any_event_ = new_event_ = true;
  event_first_ = number;
  event_start_ = now;
}

double LossHistory::event_rate() const {
  if (!any_event_) return 0;
  // RFC 5348 5.4: use the longer mean, with or without the current interval.
  const auto open = static_cast<double>(next_ - std::min(event_first_, next_));
  double closed_sum = 0, closed_weight = 0, open_sum = open * kWeights[0], open_weight = kWeights[0];
  for (std::size_t i = 0; i < interval_count_; ++i) {
    closed_sum += intervals_[i] * kWeights[i];
    closed_weight += kWeights[i];
    if (i + 1 >= kWeights.size()) continue;
    open_sum += intervals_[i] * kWeights[i + 1];
    open_weight += kWeights[i + 1];
  }
  const double mean = std::max(closed_sum / closed_weight, open_sum / open_weight);
  return std::min(1.0, 1 / std::max(mean, 1.0));
}

bool LossHistory::clear_new_event() { return std::exchange(new_event_, false); }

double LossHistory::measure_receive_rate(Instant now) {
  const double span = seconds(now - window_start_);
  if (span > 0) last_rate_ = static_cast<double>(window_bytes_) / span;
  window_bytes_ = 0;
  window_start_ = now;
  return last_rate_;
}

RateController::RateController(CongestionResponse response, double grant, Instant round_trip, Instant now)
    : response_(response),
      grant_(grant),
      round_trip_(std::clamp(round_trip, kShortestTrip, kLongestTrip)),
      doubled_(now),
      silence_(now + Instant(2'000'000)) {
  rate_ = initial();
  limit();
}

double RateController::least() const { return kPacket / seconds(round_trip_); }
double RateController::initial() const { return 10 * kPacket / seconds(round_trip_); }

void RateController::limit() {
  if (response_ == CongestionResponse::reserved) rate_ = grant_;
  rate_ = std::min(std::max(rate_, least()), grant_);
}

void RateController::set_grant(double grant) {
  grant_ = grant;
  limit();
}

void RateController::feedback(const Feedback& feedback, Instant now) {
  const Instant sample = std::clamp(feedback.round_trip, kShortestTrip, kLongestTrip);
  round_trip_ = sampled_ ? (round_trip_ * 9 + sample) / 10 : sample;
  sampled_ = true;
  // Limit the rate to twice the received rate, the maximum of the last two reports (RFC 5348 4.3).
  const double arrived = std::max(feedback.receive_rate, previous_receive_);
  previous_receive_ = feedback.receive_rate;
  const double most = feedback.limited ? std::numeric_limits<double>::infinity() : 2 * arrived;
  if (feedback.loss_rate > 0) {
    rate_ = std::min(tcp_rate(kPacket, seconds(round_trip_), feedback.loss_rate), most);
  } else if (now >= doubled_ + round_trip_) {
    if (!feedback.limited) rate_ = std::max(std::min(2 * rate_, most), initial());
    doubled_ = now;
  }
  limit();
  // Reports are received up to five times per second.
  const double patience = std::max({4 * seconds(round_trip_), 2 * kPacket / std::max(rate_, 1.0), 0.5});
  silence_ = now + Instant(static_cast<std::int64_t>(std::min(patience, 60.0) * 1e6));
}

void RateController::tick(Instant now) {
  if (now < silence_) return;
  rate_ /= 2;
  limit();
  silence_ = now + std::max(4 * round_trip_, Instant(200'000));
}

}  // namespace gs::net
