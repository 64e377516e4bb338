#include "render/gaussians/gaussian_order.h"

#include "base/parallel.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

namespace gs::render {
namespace {

constexpr unsigned kMostDigitBits = 13;                // the counts of a digit fit into the first-level cache
constexpr std::size_t kLeastPart = 16384, kParts = 8;  // keys that one task counts and moves

}  // namespace

void sort_gaussians(std::vector<GaussianKey>& keys, std::vector<GaussianKey>& other, unsigned threads) {
  const std::size_t count = keys.size();
  if (count < 2) return;
  const std::size_t parts = std::clamp<std::size_t>(count / kLeastPart, 1, kParts);
  const auto [least, most] = std::ranges::minmax(keys, {}, &GaussianKey::key);
  const auto bits = static_cast<unsigned>(std::bit_width(most.key - least.key));
  if (bits == 0) return;
  const unsigned passes = (bits + kMostDigitBits - 1) / kMostDigitBits, digit_bits = (bits + passes - 1) / passes;
  const std::size_t digits = std::size_t{1} << digit_bits;
  const std::uint32_t first_key = least.key;
  other.resize(count);
  std::vector<std::uint32_t> places(parts * digits);
  for (unsigned pass = 0; pass < passes; ++pass) {
    const auto digit_of = [&](const GaussianKey& key) {
      return (key.key - first_key) >> (pass * digit_bits) & (digits - 1);
    };
    const auto for_part = [&](std::size_t part, const auto& use) {
      const std::size_t last = count * (part + 1) / parts;
      for (std::size_t i = count * part / parts; i < last; ++i) use(keys.data()[i], places.data() + part * digits);
    };
    std::ranges::fill(places, 0u);
    parallel_for(
        parts,
        [&](std::size_t part) {
          for_part(part, [&](const GaussianKey& key, std::uint32_t* own) { ++own[digit_of(key)]; });
        },
        threads);
    std::uint32_t next = 0;
    for (std::size_t digit = 0; digit < digits; ++digit)
      for (std::size_t part = 0; part < parts; ++part)
        next += std::exchange(places.data()[part * digits + digit], next);
    parallel_for(
        parts,
        [&](std::size_t part) {
          for_part(part, [&](const GaussianKey& key, std::uint32_t* own) { other.data()[own[digit_of(key)]++] = key; });
        },
        threads);
    keys.swap(other);
  }
}

}  // namespace gs::render
