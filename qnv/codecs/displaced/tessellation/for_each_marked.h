#pragma once

#include "base/parallel.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Calls work(patch) for each marked patch, on several threads at once.
template <class Work>
void for_each_marked(const std::vector<char>& marks, const Work& work) {
  std::vector<std::uint32_t> marked;
  for (std::uint32_t p = 0; p < marks.size(); ++p)
    if (marks[p]) marked.push_back(p);
  constexpr std::size_t kAtOnce = 16;  // patches per task
  const std::size_t tasks = (marked.size() + kAtOnce - 1) / kAtOnce;
  const auto task = [&](std::size_t t) {
    for (std::size_t i = t * kAtOnce; i < std::min((t + 1) * kAtOnce, marked.size()); ++i) work(marked[i]);
  };
  if (tasks == 1) task(0);
  if (tasks > 1) parallel_for(tasks, task);
}

}  // namespace gs::qnv
