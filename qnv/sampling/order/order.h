#pragma once

#include "base/parallel.h"
#include "qnv/base/description.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

struct OrderOptions {
  std::uint64_t seed = 1;  // another seed gives another order of the same quality
  Kind kind = Kind::surface;     // meaning of the weights
  unsigned threads = 0;  // 0 means one per core; does not affect the order
  Progress* progress = nullptr;  // stops if `cancelled` is set
};

/// Returns a progressive order: a permutation of 0..positions.size()-1 in which every prefix covers the object evenly.
/// Each vector is approximately the one farthest from all earlier vectors (farthest-point sampling, Gonzalez 1985; the
/// largest hole of every prefix is at most twice the optimum). The search goes level by level through an octree. At a
/// level, it takes vectors as long as they are farther than t from the taken vectors, for t = side 2^(-k/4).
/// Surface: vectors with normals more than 104 degrees apart do not count as near, so that both sides of a thin sheet
/// are covered. Where normals vary, up to three times as many vectors are taken. Volume: the spacing halves for every
/// factor of eight in magnitude (down to 8^-5 of the 99th percentile), so that the density of the taken vectors follows
/// the magnitude.
/// The spans have equal lengths, below 2^32; `normals` may be empty. The order depends only on the input and the seed,
/// not on the number of threads. Values that are not finite get an arbitrary position in the order. Returns an empty
/// list if cancelled. Throws only bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> progressive_order(std::span<const glm::vec3> positions,
                                                           std::span<const glm::vec3> normals,
                                                           std::span<const float> weights, const OrderOptions& options);

}  // namespace gs::qnv
