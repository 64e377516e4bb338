#include "qnv/codecs/values/bricks/brick_samples.h"

#include "qnv/codecs/values/decode/split_lifting.h"

#include <algorithm>
#include <cstring>

namespace gs::qnv::values {

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
  thread_local std::vector<std::int32_t> room;
  const SplitWindow window = window_around(box, extent, room);
  coarser.read(low_box(window), window.samples, 2 * window.row, 2 * window.row * window.size[1]);
  for (const Block* const block : blocks) block->write_split(window);
  BrickSamples made{level, box, std::vector<std::int32_t>(sample_count(box.size))};
  std::int32_t* to = made.samples.data();
  unlift_window(window, box,
                [&](std::uint32_t, std::uint32_t, const std::int32_t* row) { to = std::copy_n(row, box.size[0], to); });
  return made;
}

}  // namespace gs::qnv::values
