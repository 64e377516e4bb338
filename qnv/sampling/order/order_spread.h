#pragma once

#include "qnv/sampling/order/order_points.h"

#include <array>
#include <cstdint>
#include <vector>

/// Core of progressive_order(): orders one tree's points by (approximate) farthest-point sampling.
namespace gs::qnv::order {

/// Point of a tree, with its distance from the earlier points: approximately at least side * 2^(-step/4).
struct Taken {
  std::uint32_t point;
  std::uint32_t step;
};

struct SpreadOptions {
  std::uint64_t seed = 1;
  bool surface = true;  // uses normals to tell sides apart
  unsigned threads = 0;
  Progress* progress = nullptr;
};

/// Returns all points of the tree in order, and sets their densities. Incomplete if cancelled.
[[nodiscard]] std::vector<Taken> spread(Tree& tree, const SpreadOptions& options);

/// Position and normal of a taken point.
struct Centre {
  float x, y, z, nx, ny, nz;
};

/// Lowers gaps[i], for points first..last-1, to the squared distance to the centre times points.density[i]. If
/// `surface`, skips points that face away from the centre. All processors give the same bits.
using Relax = void (*)(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                       float* gaps);
void relax_portable(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                    float* gaps);
void relax_avx2(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                float* gaps);
[[nodiscard]] bool has_relax_avx2();

}  // namespace gs::qnv::order
