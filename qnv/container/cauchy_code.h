#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

// Reed-Solomon parity with a Cauchy matrix (J. Bloemer et al., "An XOR-based erasure-resilient coding scheme", 1995).
// The field has 256 elements. Every square submatrix is invertible, so that any k of all pieces restore k data pieces.

/// Maximum number of data and parity pieces of a group together.
inline constexpr std::size_t kMaxCodedPieces = 256;

/// Returns the matrix coefficient of data piece `data` in parity piece `parity`. The numbers differ and are below
/// kMaxCodedPieces.
[[nodiscard]] std::uint8_t cauchy_weight(std::size_t parity, std::size_t data);

/// Computes sum += weight * bytes. `bytes` may be shorter than `sum`; zeros follow.
void add_weighted(std::span<std::byte> sum, std::uint8_t weight, std::span<const std::byte> bytes);

/// Equation of a parity piece: its coefficients of the missing pieces, and the weighted sum of these pieces.
struct CodeEquation {
  std::vector<std::uint8_t> weights;
  std::vector<std::byte> sum;
};
/// Solves as many equations as pieces are missing, with coefficients of the Cauchy matrix. Sums have equal sizes. Sum i
/// becomes missing piece i.
void solve_pieces(std::vector<CodeEquation>& equations);

}  // namespace gs::qnv
