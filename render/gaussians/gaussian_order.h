#pragma once

#include <cstdint>
#include <vector>

namespace gs::render {

/// Sort key of a splat, and the index of the splat.
struct GaussianKey {
  std::uint32_t key, index;
};

/// Sorts by key, ascending; equal keys keep their order. Radix sort on `threads` threads (0 means one per core). The
/// result does not depend on the number of threads. `other` is scratch memory that callers may reuse.
void sort_gaussians(std::vector<GaussianKey>& keys, std::vector<GaussianKey>& other, unsigned threads);

}  // namespace gs::render
