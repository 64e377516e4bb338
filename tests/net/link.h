#pragma once

#include "net/limits/token_bucket.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::net {

/// One direction of a simulated network. Equal seeds and calls give equal results, bit for bit.
class Link {
 public:
  struct Options {
    Instant latency{0};
    std::uint64_t bandwidth = 0;     // bits per second; 0 means unlimited
    std::size_t queue = 256 * 1024;  // maximum bytes that wait for the bandwidth; further packets are dropped
    double loss = 0, duplicated = 0, reordered = 0;
    Instant reordered_by{20'000};
    bool cut = false;  // nothing passes
    double burst = 1;  // mean length of runs of losses (Gilbert's model); 1 for independent losses
  };
  Link(Options options, std::uint64_t seed) : options_(options), random_(seed * 2 + 1) {}

  void set(const Options& options) { options_ = options; }
  [[nodiscard]] const Options& options() const { return options_; }

  void send(std::span<const std::byte> bytes, Instant now) {
    ++sent_;
    sent_bytes_ += bytes.size();
    if (options_.cut || lost()) return;
    Instant leaves = now;
    if (options_.bandwidth > 0) {
      const std::uint64_t size = bytes.size() + 28;
      const Instant free = free_ > now ? free_ : now;
      const auto waiting = static_cast<std::uint64_t>((free - now).count()) * options_.bandwidth / 8'000'000;
      if (waiting + size > options_.queue) {
        ++dropped_;
        return;
      }
      free_ = free + Instant(static_cast<std::int64_t>(size * 8'000'000 / options_.bandwidth));
      leaves = free_;
    }
    Instant arrives = leaves + options_.latency;
    if (chance(options_.reordered)) arrives += options_.reordered_by;
    put(arrives, bytes);
    if (chance(options_.duplicated)) put(arrives + Instant(100), bytes);
  }
  [[nodiscard]] Instant deadline() const {
    return under_way_.empty() ? Instant::max() : under_way_.begin()->first.first;
  }
  [[nodiscard]] std::optional<std::vector<std::byte>> take(Instant now) {
    if (deadline() > now) return std::nullopt;
    auto bytes = std::move(under_way_.begin()->second);
    under_way_.erase(under_way_.begin());
    return bytes;
  }
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  [[nodiscard]] std::uint64_t sent_bytes() const { return sent_bytes_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  /// SplitMix64.
  static std::uint64_t next_random(std::uint64_t& state) {
    std::uint64_t value = state += 0x9e3779b97f4a7c15;
    value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9;
    value = (value ^ value >> 27) * 0x94d049bb133111eb;
    return value ^ value >> 31;
  }

 private:
  bool chance(double share) { return share > 0 && static_cast<double>(next_random(random_) >> 11) * 0x1p-53 < share; }
  bool lost() {
    if (options_.burst <= 1) return chance(options_.loss);
    const double begin = options_.loss / (1 - options_.loss) / options_.burst;
    bad_ = bad_ ? !chance(1 / options_.burst) : chance(begin);
    return bad_;
  }
  void put(Instant at, std::span<const std::byte> bytes) {
    under_way_.emplace(std::pair(at, count_++), std::vector<std::byte>(bytes.begin(), bytes.end()));
  }
  Options options_;
  std::uint64_t random_, count_ = 0, sent_ = 0, sent_bytes_ = 0, dropped_ = 0;
  Instant free_{};
  bool bad_ = false;
  std::map<std::pair<Instant, std::uint64_t>, std::vector<std::byte>> under_way_;
};

}  // namespace gs::net
