#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/parallel.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

struct OrderOptions {
  std::uint64_t seed = 1;        // another seed, another order of the same quality
  Kind kind = Kind::surface;     // what the weights are
  unsigned threads = 0;          // 0: one a core; the order does not depend on it
  Progress* progress = nullptr;  // watched for `cancelled`
};

/// The progressive order: a permutation of 0..positions.size()-1 of which every prefix covers the whole object evenly.
///
/// Each vector is about the one furthest from all before it (farthest-point sampling, Gonzalez 1985, whose
/// every prefix is within a factor of two of the smallest possible largest hole), found level by level in an octree:
/// at a level, vectors are taken as long as they are further than t from those taken, for t = side 2^(-k/4).
/// Surface: vectors that face away from each other (their normals differ by more than 104 degrees) do not count as
/// near, so that both sides of a thin sheet are covered; where normals vary, up to three times as many are taken.
/// Volume: spacing halves for every factor of eight in the magnitude (down to 8^-5 of the largest hundredth), so
/// that the density of the vectors taken goes with the magnitude.
///
/// The spans have the same length, below 2^32; `normals` may be empty. The order is the same for the same input and
/// seed, whatever the number of threads. Values that are not finite are sorted in somewhere. Empty when
/// cancelled. Throws only bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> progressive_order(std::span<const glm::vec3> positions,
                                                           std::span<const glm::vec3> normals,
                                                           std::span<const float> weights, const OrderOptions& options);

}  // namespace gs::qnv
