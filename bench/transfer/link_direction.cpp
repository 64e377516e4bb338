#include "bench/transfer/link_direction.h"

#include <algorithm>
#include <cmath>

namespace gs::bench {
namespace {

constexpr double kNanoseconds = 1e9;
constexpr double kMinQueue = 32'000;  // bytes

}  // namespace

std::size_t queue_bytes(const LinkSpec& spec) {
  return static_cast<std::size_t>(std::max(kMinQueue, spec.bits_per_second / 8 * spec.round_trip));
}

LinkDirection::LinkDirection(const LinkSpec& spec, std::uint64_t seed)
    : spec_(spec), queue_bytes_(queue_bytes(spec)), random_(seed) {}

// SplitMix64 (Steele, Lea, Flood 2014), as a number in [0, 1).
double LinkDirection::chance() {
  random_ += 0x9e3779b97f4a7c15;
  std::uint64_t z = random_;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
  z = (z ^ z >> 27) * 0x94d049bb133111eb;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-53;
}

void LinkDirection::offer(std::vector<std::byte> packet, Nanoseconds now) {
  // Draws both random numbers for every packet, even if the queue refuses it. So equal seeds lose equal packets.
  const bool lost = chance() < spec_.loss;
  const bool late = chance() < spec_.reordered;
  ++counts_.packets;
  counts_.bytes += packet.size();
  const auto arrival = static_cast<double>(now);
  const double waiting = std::max(0.0, line_free_ - arrival) / kNanoseconds * spec_.bits_per_second / 8;
  const auto size = static_cast<double>(packet.size());
  if (waiting + size > static_cast<double>(queue_bytes_)) {
    ++counts_.refused;
    return;
  }
  line_free_ = std::max(line_free_, arrival) + size * 8 / spec_.bits_per_second * kNanoseconds;
  if (lost) {
    ++counts_.lost;
    return;
  }
  const double delay = spec_.round_trip / 2 + (late ? spec_.reorder_delay : 0);
  under_way_.emplace(std::llround(line_free_ + delay * kNanoseconds), std::move(packet));
}

std::optional<LinkDirection::Nanoseconds> LinkDirection::due() const {
  if (under_way_.empty()) return std::nullopt;
  return under_way_.begin()->first;
}

std::optional<std::vector<std::byte>> LinkDirection::take(Nanoseconds now) {
  if (under_way_.empty() || under_way_.begin()->first > now) return std::nullopt;
  auto packet = std::move(under_way_.begin()->second);
  under_way_.erase(under_way_.begin());
  ++counts_.delivered;
  return packet;
}

namespace {

using Packet = std::vector<std::byte>;

Packet numbered(std::size_t number, std::size_t size) {
  Packet packet(size);
  for (std::size_t i = 0; i < 4; ++i) packet[i] = static_cast<std::byte>(number >> (8 * i));
  return packet;
}

std::size_t number_of(const Packet& packet) {
  std::size_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number |= std::to_integer<std::size_t>(packet[i]) << (8 * i);
  return number;
}

// 1250 bytes take 1 ms at 10 Mbit/s. A packet offered every 2 ms arrives 1 ms + 10 ms later.
std::optional<std::string> test_delay() {
  LinkDirection link({}, 1);
  for (int i = 0; i < 100; ++i) {
    link.offer(numbered(static_cast<std::size_t>(i), 1250), i * 2'000'000);
    if (link.due() != i * 2'000'000 + 11'000'000) return "a packet does not come out when it should";
    if (link.take(*link.due() - 1)) return "a packet comes out early";
    if (!link.take(*link.due())) return "a packet does not come out";
  }
  return std::nullopt;
}

// A queue of 32 kB accepts 25 packets of a burst of 100 packets of 1250 bytes. The packet on the line is one of the 25.
std::optional<std::string> test_queue() {
  LinkDirection link({}, 1);
  for (std::size_t i = 0; i < 100; ++i) link.offer(numbered(i, 1250), 0);
  if (link.counts().refused != 75) return "the queue does not hold what it should";
  for (int i = 0; i < 25; ++i) {
    if (link.due() != (i + 1) * 1'000'000 + 10'000'000) return "the line is not as fast as it should be";
    if (number_of(*link.take(*link.due())) != static_cast<std::size_t>(i)) return "the order has changed";
  }
  return link.due() ? std::optional<std::string>("a refused packet comes out") : std::nullopt;
}

// 10 % of 100,000 packets are lost, within five standard deviations (95), and still occupy the line.
std::optional<std::string> test_loss() {
  LinkSpec spec;
  spec.loss = 0.1;
  spec.reordered = 0.05;
  LinkDirection link(spec, 7);
  std::size_t overtaken = 0, last = 0;
  for (std::size_t i = 0; i < 100'000; ++i) {
    const auto now = static_cast<LinkDirection::Nanoseconds>(i) * 1'000'000;
    link.offer(numbered(i, 1250), now);
    while (const auto packet = link.take(now)) {
      const std::size_t number = number_of(*packet);
      overtaken += number < last ? 1 : 0;
      last = std::max(last, number);
    }
  }
  const auto lost = static_cast<double>(link.counts().lost);
  if (link.counts().refused != 0 || std::abs(lost - 10'000) > 5 * 95) return "not as many are lost as should be";
  // A packet that is 4 ms late arrives after the next four packets, unless these are lost. 4,500 are expected.
  if (overtaken < 4'000 || overtaken > 5'000) return "not as many are reordered as should be";
  return std::nullopt;
}

}  // namespace

std::optional<std::string> test_link_direction() {
  if (auto problem = test_delay()) return problem;
  if (auto problem = test_queue()) return problem;
  return test_loss();
}

}  // namespace gs::bench
