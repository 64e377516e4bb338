#include "qnv/codecs/values/decode/split_lifting.h"

#include "qnv/codecs/values/lifting.h"
#include "qnv/codecs/values/lifting_kernel.h"

#include <algorithm>

namespace gs::qnv::values {

namespace {

// Rows of x that are lifted together. They stay in the fastest cache.
constexpr std::size_t kLinesAtOnce = 8;

// Reverts the lifting of `count` rows along x. Each row has its even samples first, and the odd ones from `odd` on.
// There is room for a sample after the even ones, and before and after the odd ones.
void unlift_lines(std::int32_t* first, std::size_t count, const SplitWindow& window) {
  const std::size_t evens = (window.size[0] + 1) / 2, odds = window.size[0] / 2;
  if (odds == 0) return;
  for (std::size_t step = 4; step-- > 0;)
    for (std::size_t i = 0; i < count; ++i) {
      std::int32_t* const even = first + i * window.row;
      lift_halves({even, even + window.odd, evens, odds}, step, true);
    }
}

}  // namespace

SplitWindow window_around(const SampleBox& box, const Extent& extent, std::vector<std::int32_t>& room) {
  SplitWindow window;
  for (std::size_t a = 0; a < 3; ++a) {
    window.first[a] = box.first[a] - std::min(box.first[a], kLiftReach);
    window.size[a] = std::min(extent[a], box.first[a] + box.size[a] + kLiftReach) - window.first[a];
  }
  // Rows of even and of odd samples start at multiples of 8, with room for the samples that lifting repeats.
  window.odd = ((window.size[0] + 1) / 2 + 2 + 7) / 8 * 8;
  window.row = (window.odd + window.size[0] / 2 + 1 + 7) / 8 * 8;
  room.assign(window.row * window.size[1] * window.size[2], 0);
  window.samples = room.data();
  return window;
}

SampleBox low_box(const SplitWindow& window) {
  SampleBox low;
  for (std::size_t a = 0; a < 3; ++a) {
    low.first[a] = window.first[a] / 2;
    low.size[a] = (window.size[a] + 1) / 2;
  }
  return low;
}

void unlift_window(const SplitWindow& window, const SampleBox& box,
                   const std::function<void(std::uint32_t, std::uint32_t, const std::int32_t*)>& take) {
  thread_local std::vector<std::int32_t> joined;
  joined.resize(window.size[0] + 1);
  const std::size_t row = window.row, slice = row * window.size[1];
  // Later axes need only the samples of the box.
  const std::size_t y0 = box.first[1] - window.first[1], z0 = box.first[2] - window.first[2];
  unlift_rows(window.samples, window.size[2], slice, slice);
  for (std::size_t z = z0; z < z0 + box.size[2]; ++z) {
    std::int32_t* const at = window.samples + z * slice;
    unlift_rows(at, window.size[1], row, row);
    for (std::size_t y = y0; y < y0 + box.size[1]; ++y) {
      std::int32_t* const line = at + y * row;
      if ((y - y0) % kLinesAtOnce == 0) unlift_lines(line, std::min(kLinesAtOnce, y0 + box.size[1] - y), window);
      interleave(line, line + window.odd, window.size[0] / 2, joined.data());
      if (window.size[0] % 2 != 0) joined[window.size[0] - 1] = line[(window.size[0] + 1) / 2 - 1];
      take(box.first[1] + static_cast<std::uint32_t>(y - y0), box.first[2] + static_cast<std::uint32_t>(z - z0),
           joined.data() + (box.first[0] - window.first[0]));
    }
  }
}

}  // namespace gs::qnv::values
