#include "qnv/codecs/values/bricks/brick_samples.h"

#include "qnv/codecs/values/bricks/brick_places.h"
#include "qnv/codecs/values/lifting_kernel.h"

#include <algorithm>
#include <cstring>

namespace gs::qnv::values {

namespace {

// Reverts the lifting of `count` rows, `stride` apart, of `size` adjacent samples.
void unlift_brick_rows(std::int32_t* first, std::size_t count, std::size_t stride, std::size_t size) {
  for (std::size_t step = 4; step-- > 0;)
    for (std::size_t i = step % 2 == 0 ? 1 : 0; i < count; i += 2) {
      const std::size_t before = i > 0 ? i - 1 : 1;
      const std::size_t after = i + 1 < count ? i + 1 : i - 1;
      lift(first + i * stride, first + before * stride, first + after * stride, size, step, true);
    }
}

}  // namespace

bool BrickSamples::contains(const SampleBox& part) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (part.first[a] < box.first[a] || part.first[a] + part.size[a] > box.first[a] + box.size[a]) return false;
  return true;
}

void BrickSamples::read(const SampleBox& part, std::int32_t* to, std::size_t row, std::size_t slice) const {
  const std::size_t own_row = box.size[0], own_slice = own_row * box.size[1];
  const std::int32_t* const from = samples.data() + (part.first[2] - box.first[2]) * own_slice +
                                   (part.first[1] - box.first[1]) * own_row + (part.first[0] - box.first[0]);
  for (std::size_t z = 0; z < part.size[2]; ++z)
    for (std::size_t y = 0; y < part.size[1]; ++y)
      std::memcpy(to + z * slice + y * row, from + z * own_slice + y * own_row, part.size[0] * sizeof(std::int32_t));
}

BrickSamples lift_brick(int level, const SampleBox& box, const Extent& extent, const BrickSamples& coarser,
                        std::span<const Block* const> blocks) {
  SplitWindow window;
  SampleBox low;
  for (std::size_t a = 0; a < 3; ++a) {
    window.first[a] = box.first[a] - std::min(box.first[a], kBrickMargin);
    window.size[a] = std::min(extent[a], box.first[a] + box.size[a] + kBrickMargin) - window.first[a];
    low.first[a] = window.first[a] / 2;
    low.size[a] = (window.size[a] + 1) / 2;
  }
  thread_local std::vector<std::int32_t> samples, joined, line;
  samples.assign(sample_count(window.size), 0);
  joined.resize(window.size[0]);
  window.samples = samples.data();
  const std::size_t row = window.size[0], slice = row * window.size[1];
  coarser.read(low, samples.data(), 2 * row, 2 * slice);
  for (const Block* const block : blocks) block->write_split(window);
  BrickSamples made{level, box, std::vector<std::int32_t>(sample_count(box.size))};
  std::int32_t* to = made.samples.data();
  // Later axes need only the samples of the box.
  const std::size_t x0 = box.first[0] - window.first[0], y0 = box.first[1] - window.first[1],
                    z0 = box.first[2] - window.first[2];
  if (window.size[2] > 1) unlift_brick_rows(samples.data(), window.size[2], slice, slice);
  for (std::size_t z = z0; z < z0 + box.size[2]; ++z) {
    std::int32_t* const at = samples.data() + z * slice;
    if (window.size[1] > 1) unlift_brick_rows(at, window.size[1], row, row);
    for (std::size_t y = y0; y < y0 + box.size[1]; ++y, to += box.size[0]) {
      const std::int32_t* from = at + y * row;
      if (row > 1) {
        join_line(from, joined.data(), row, line);
        from = joined.data();
      }
      std::memcpy(to, from + x0, box.size[0] * sizeof(std::int32_t));
    }
  }
  return made;
}

}  // namespace gs::qnv::values
