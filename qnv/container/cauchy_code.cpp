#include "qnv/container/cauchy_code.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gs::qnv {
namespace {

/// Finite field with 256 elements, modulo the polynomial x^8 + x^4 + x^3 + x^2 + 1.
struct Field {
  std::array<std::uint8_t, 512> power{};
  std::array<std::uint8_t, 256> logarithm{};
  constexpr Field() {
    unsigned value = 1;
    for (std::size_t i = 0; i < 255; ++i) {
      power[i] = power[i + 255] = static_cast<std::uint8_t>(value);
      logarithm[value] = static_cast<std::uint8_t>(i);
      value <<= 1;
      if (value > 255) value ^= 0x11d;
    }
  }
  [[nodiscard]] constexpr std::uint8_t times(std::uint8_t a, std::uint8_t b) const {
    return a == 0 || b == 0 ? 0 : power[std::size_t{logarithm[a]} + logarithm[b]];
  }
  [[nodiscard]] constexpr std::uint8_t inverse(std::uint8_t a) const { return power[255u - logarithm[a]]; }
};
constexpr Field kField;

}  // namespace

std::uint8_t cauchy_weight(std::size_t parity, std::size_t data) {
  return kField.inverse(static_cast<std::uint8_t>(parity ^ data));
}

void add_weighted(std::span<std::byte> sum, std::uint8_t weight, std::span<const std::byte> bytes) {
  std::array<std::byte, 256> products;
  for (std::size_t i = 0; i < products.size(); ++i)
    products[i] = static_cast<std::byte>(kField.times(weight, static_cast<std::uint8_t>(i)));
  const std::size_t size = std::min(sum.size(), bytes.size());
  for (std::size_t i = 0; i < size; ++i) sum[i] ^= products[std::to_integer<std::size_t>(bytes[i])];
}

// Gauss-Jordan elimination. A pivot always exists, because the matrix is invertible.
void solve_pieces(std::vector<CodeEquation>& equations) {
  for (std::size_t c = 0; c < equations.size(); ++c) {
    std::size_t pivot = c;
    while (equations[pivot].weights[c] == 0) ++pivot;
    std::swap(equations[c], equations[pivot]);
    const std::uint8_t scale = kField.inverse(equations[c].weights[c]);
    for (std::uint8_t& w : equations[c].weights) w = kField.times(w, scale);
    std::vector<std::byte> scaled(equations[c].sum.size());
    add_weighted(scaled, scale, equations[c].sum);
    equations[c].sum = std::move(scaled);
    for (std::size_t r = 0; r < equations.size(); ++r) {
      const std::uint8_t by = equations[r].weights[c];
      if (r == c || by == 0) continue;
      for (std::size_t k = c; k < equations.size(); ++k)
        equations[r].weights[k] ^= kField.times(by, equations[c].weights[k]);
      add_weighted(equations[r].sum, by, equations[c].sum);
    }
  }
}

}  // namespace gs::qnv
