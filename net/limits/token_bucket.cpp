#include "net/limits/token_bucket.h"

#include <algorithm>

namespace gs::net {
namespace {

constexpr std::int64_t kMicro = 1'000'000;
constexpr std::uint64_t kFastest = std::uint64_t{1} << 33, kLargestBurst = std::uint64_t{1} << 40;
constexpr std::int64_t kLongestPause = 60 * kMicro;  // microseconds; kLongestPause * kFastest must not overflow

}  // namespace

TokenBucket::TokenBucket(std::uint64_t bytes_per_second, std::uint64_t burst, Instant now) : filled_(now) {
  set_rate(bytes_per_second, burst, now);
  credit_ = static_cast<std::int64_t>(burst_) * kMicro;
}

void TokenBucket::set_rate(std::uint64_t bytes_per_second, std::uint64_t burst, Instant now) {
  fill(now);
  rate_ = std::min(bytes_per_second, kFastest);
  burst_ = std::min(burst, kLargestBurst);
  credit_ = std::min(credit_, static_cast<std::int64_t>(burst_) * kMicro);
}

void TokenBucket::fill(Instant now) {
  if (now <= filled_) return;
  const std::int64_t pause = std::min<std::int64_t>((now - filled_).count(), kLongestPause);
  filled_ = now;
  credit_ = std::min(credit_ + pause * static_cast<std::int64_t>(rate_), static_cast<std::int64_t>(burst_) * kMicro);
}

void TokenBucket::allow_debt(std::uint64_t bytes) {
  debt_ = static_cast<std::int64_t>(std::min(bytes, kLargestBurst)) * kMicro;
}

bool TokenBucket::has(std::uint64_t bytes, Instant now) {
  fill(now);
  return credit_ + (rate_ > 0 ? debt_ : 0) >= static_cast<std::int64_t>(std::min(bytes, burst_)) * kMicro;
}

void TokenBucket::take(std::uint64_t bytes, Instant now) {
  fill(now);
  credit_ -= static_cast<std::int64_t>(std::min(bytes, kLargestBurst)) * kMicro;
}

Instant TokenBucket::when(std::uint64_t bytes, Instant now) {
  if (has(bytes, now)) return now;
  if (rate_ == 0) return Instant::max();
  const std::int64_t lacking = static_cast<std::int64_t>(std::min(bytes, burst_)) * kMicro - credit_ - debt_;
  const auto rate = static_cast<std::int64_t>(rate_);
  return now + Instant((lacking + rate - 1) / rate);
}

}  // namespace gs::net
