#pragma once

#include <cstdint>
#include <vector>

namespace gs::render {

/// Sort key of a splat, and the number of the splat.
struct GaussianKey {
  std::uint32_t key, index;
};

/// Sorts by key, ascending; equal keys keep their order. Radix sort on `threads` threads (0 means one per core). The
/// result does not depend on their number. `other` is memory that a caller may reuse; its content is undefined.
void sort_gaussians(std::vector<GaussianKey>& keys, std::vector<GaussianKey>& other, unsigned threads);

}  // namespace gs::render
