#include "qnv/codecs/values/decode/sample_bricks.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace gs::qnv::values {

SampleBricks::SampleBricks(Extent extent) : extent_(extent) {
  for (std::size_t a = 0; a < 3; ++a) count_[a] = extent[a] / kBrick[a] + (extent[a] % kBrick[a] != 0 ? 1 : 0);
  bricks_.resize(sample_count(count_));
  ages_.assign(bricks_.size(), 0);
}

std::uint64_t SampleBricks::bytes() const {
  const auto used = std::ranges::count_if(bricks_, [](const auto& brick) { return brick != nullptr; });
  return static_cast<std::uint64_t>(used) * sizeof(Brick);
}

void SampleBricks::read(const SampleBox& box, std::int32_t* to, std::size_t row, std::size_t slice) const {
  for (std::uint32_t z = 0; z < box.size[2]; ++z)
    for (std::uint32_t y = 0; y < box.size[1]; ++y) {
      std::int32_t* const line = to + z * slice + y * row;
      const std::uint32_t at_y = box.first[1] + y, at_z = box.first[2] + z;
      for (std::uint32_t x = 0; x < box.size[0];) {
        const std::uint32_t at_x = box.first[0] + x;
        const std::uint32_t count = std::min(kBrick[0] - at_x % kBrick[0], box.size[0] - x);
        if (const Brick* const brick = bricks_[number(at_x, at_y, at_z)].get())
          std::memcpy(line + x, brick->data() + place(at_x, at_y, at_z), count * sizeof(std::int32_t));
        else
          std::memset(line + x, 0, count * sizeof(std::int32_t));
        x += count;
      }
    }
}

void SampleBricks::open(std::span<const SampleBox> boxes) {
  std::vector<std::size_t> old;
  for (const SampleBox& box : boxes) {
    Extent low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = box.first[a] / kBrick[a];
      high[a] = (box.first[a] + box.size[a] - 1) / kBrick[a];
    }
    for (std::uint32_t z = low[2]; z <= high[2]; ++z)
      for (std::uint32_t y = low[1]; y <= high[1]; ++y)
        for (std::uint32_t x = low[0]; x <= high[0]; ++x) {
          const std::size_t i = (std::size_t{z} * count_[1] + y) * count_[0] + x;
          if (ages_[i] == age_) continue;
          ages_[i] = age_;
          old.push_back(i);
        }
  }
  constexpr std::size_t kPart = 16;
  parallel_for((old.size() + kPart - 1) / kPart, [&](std::size_t part) {
    for (std::size_t i = part * kPart; i < std::min(old.size(), (part + 1) * kPart); ++i) {
      std::shared_ptr<Brick>& brick = bricks_[old[i]];
      brick = brick ? std::make_shared<Brick>(*brick) : std::make_shared<Brick>();
    }
  });
}

void SampleBricks::write(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t count,
                         const std::int32_t* from, UnitMask& changed) {
  while (count > 0) {
    const std::uint32_t part = std::min(kBrick[0] - x % kBrick[0], count);
    std::int32_t* const to = bricks_[number(x, y, z)]->data() + place(x, y, z);
    // Units start at multiples of their edge, a power of two, like rows of bricks.
    const std::uint32_t edge = changed.edge();
    std::uint8_t* flag = changed.flag(x, y, z);
    for (std::uint32_t i = 0, n = 0; i < part; i += n, ++flag) {
      n = std::min(edge - (x + i) % edge, part - i);
      if (n == 4) {
        // The most frequent size. Without a branch.
        std::array<std::uint64_t, 2> old, now;
        std::memcpy(old.data(), to + i, sizeof old);
        std::memcpy(now.data(), from + i, sizeof now);
        *flag |= static_cast<std::uint8_t>(((old[0] ^ now[0]) | (old[1] ^ now[1])) != 0);
        std::memcpy(to + i, now.data(), sizeof now);
      } else if (std::memcmp(to + i, from + i, n * sizeof(std::int32_t)) != 0) {
        *flag = 1;
        std::memcpy(to + i, from + i, n * sizeof(std::int32_t));
      }
    }
    x += part;
    from += part;
    count -= part;
  }
}

}  // namespace gs::qnv::values
