#pragma once

#include "qnv/order/order_points.h"

#include <array>
#include <cstdint>
#include <vector>

/// The heart of progressive_order: one tree's points, each the one furthest from those before it, or nearly.
namespace gs::qnv::order {

/// A point of a tree, and how far it was from those before it: at least side * 2^(-step/4), about.
struct Taken {
  std::uint32_t point;
  std::uint32_t step;
};

struct SpreadOptions {
  std::uint64_t seed = 1;
  bool surface = true;  // normals tell sides apart
  unsigned threads = 0;
  Progress* progress = nullptr;
};

/// All points of the tree, whose densities it sets; short when cancelled.
[[nodiscard]] std::vector<Taken> spread(Tree& tree, const SpreadOptions& options);

/// Where a point was taken, and which way it looks.
struct Centre {
  float x, y, z, nx, ny, nz;
};

/// For points first..last-1: gaps[i] becomes the least of itself and the squared distance to the centre times
/// points.density[i], unless `surface` and the two look away from each other. The same bits on every processor.
using Relax = void (*)(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                       float* gaps);
void relax_portable(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                    float* gaps);
void relax_avx2(const Points& points, std::size_t first, std::size_t last, const Centre& centre, bool surface,
                float* gaps);
[[nodiscard]] bool has_relax_avx2();

}  // namespace gs::qnv::order
