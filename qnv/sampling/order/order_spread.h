#pragma once

#include "qnv/sampling/order/order_points.h"

#include <array>
#include <cstdint>
#include <vector>

/// Core of progressive_order(): orders the points of one tree by approximate farthest-point sampling.
namespace gs::qnv::order {

/// Point that is taken from a tree. Its distance from all points taken before is approximately at least side *
/// 2^(-step/4).
struct Taken {
  std::uint32_t point;
  std::uint32_t step;
};

struct SpreadOptions {
  std::uint64_t seed = 1;
  bool surface = true;  // distinguishes both sides of a surface by normals
  unsigned threads = 0;
  Progress* progress = nullptr;
};

/// Returns all points of the tree in order. Sets their densities in the tree. The result is incomplete if cancelled.
[[nodiscard]] std::vector<Taken> spread(Tree& tree, const SpreadOptions& options);

/// Position and normal of a taken point, from which distances are measured.
struct Centre {
  float x, y, z, nx, ny, nz;
};

/// Lowers gaps[i], for the points from `first` up to `last` (excluded), to the squared distance to the centre times
/// points.density[i]. If `surface`, ignores points that face away from the centre. All processors give the same bits.
using Relax = void (*)(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                       float* gaps);
void relax_portable(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                    float* gaps);
void relax_avx2(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                float* gaps);
[[nodiscard]] bool has_relax_avx2();

}  // namespace gs::qnv::order
