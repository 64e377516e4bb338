#pragma once

#include <cstddef>
#include <cstdint>

namespace gs::simulation {

/// Sequence of random numbers that depends on the seed only (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t value = state_ += 0x9e3779b97f4a7c15;
    value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9;
    value = (value ^ value >> 27) * 0x94d049bb133111eb;
    return value ^ value >> 31;
  }
  /// Returns a number from 0 to before 1.
  double share() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  bool chance(double probability) { return share() < probability; }
  /// Returns a number from `least` to `most`.
  std::uint64_t between(std::uint64_t least, std::uint64_t most) { return least + next() % (most - least + 1); }
  double between(double least, double most) { return least + (most - least) * share(); }
  template <class Container>
  const auto& one_of(const Container& all) {
    return all[static_cast<std::size_t>(next() % all.size())];
  }

 private:
  std::uint64_t state_;
};

}  // namespace gs::simulation
