#include "qnv/codecs/values/decode/unit_mask.h"

#include <algorithm>
#include <cstring>

namespace gs::qnv::values {

UnitMask::UnitMask(Extent extent, std::uint32_t edge) : extent_(extent), edge_(edge) {
  for (std::size_t a = 0; a < 3; ++a) count_[a] = extent[a] / edge + (extent[a] % edge != 0 ? 1 : 0);
  units_.assign(sample_count(count_), 0);
}

void UnitMask::mark(std::array<std::int64_t, 3> first, std::array<std::int64_t, 3> last) {
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = std::max<std::int64_t>(first[a], 0) / edge_;
    last[a] = (std::min<std::int64_t>(last[a], extent_[a]) + edge_ - 1) / edge_;
    if (first[a] >= last[a]) return;
  }
  const auto begin = static_cast<std::size_t>(first[0]), size = static_cast<std::size_t>(last[0] - first[0]);
  for (auto z = static_cast<std::size_t>(first[2]); z < static_cast<std::size_t>(last[2]); ++z)
    for (auto y = static_cast<std::size_t>(first[1]); y < static_cast<std::size_t>(last[1]); ++y)
      std::memset(units_.data() + (z * count_[1] + y) * count_[0] + begin, 1, size);
}

void UnitMask::mark_all() { std::ranges::fill(units_, std::uint8_t{1}); }

bool UnitMask::full(Extent first, Extent size) const {
  for (std::uint32_t z = first[2]; z < first[2] + size[2]; ++z)
    for (std::uint32_t y = first[1]; y < first[1] + size[1]; ++y) {
      const std::uint8_t* const row = units_.data() + (std::size_t{z} * count_[1] + y) * count_[0] + first[0];
      if (std::memchr(row, 0, size[0])) return false;
    }
  return true;
}

std::vector<SampleBox> UnitMask::take(Extent most) {
  std::vector<SampleBox> boxes;
  const std::uint8_t* const begin = units_.data();
  std::size_t at = 0;
  while (at < units_.size()) {
    const void* const found = std::memchr(begin + at, 1, units_.size() - at);
    if (!found) break;
    at = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - begin);
    const Extent first{static_cast<std::uint32_t>(at % count_[0]),
                       static_cast<std::uint32_t>(at / count_[0] % count_[1]),
                       static_cast<std::uint32_t>(at / count_[0] / count_[1])};
    // The box grows along x, then y, then z, while all of its units are in the set.
    Extent size{1, 1, 1};
    for (std::size_t a = 0; a < 3; ++a)
      while (size[a] < most[a] && first[a] + size[a] < count_[a]) {
        Extent side = first, one = size;
        side[a] += size[a];
        one[a] = 1;
        if (!full(side, one)) break;
        ++size[a];
      }
    for (std::uint32_t z = first[2]; z < first[2] + size[2]; ++z)
      for (std::uint32_t y = first[1]; y < first[1] + size[1]; ++y)
        std::memset(units_.data() + (std::size_t{z} * count_[1] + y) * count_[0] + first[0], 0, size[0]);
    SampleBox box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.first[a] = first[a] * edge_;
      box.size[a] = std::min(size[a] * edge_, extent_[a] - box.first[a]);
    }
    boxes.push_back(box);
  }
  return boxes;
}

std::vector<SampleBox> UnitMask::take_for(Extent most, std::uint32_t margin) {
  std::vector<SampleBox> boxes = take(most);
  double read = 0, all = 1;
  for (const SampleBox& box : boxes) {
    double samples = 1;
    for (const std::uint32_t n : box.size) samples *= static_cast<double>(n) + 2.0 * margin;
    read += samples;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const double edge = static_cast<double>(most[a]) * edge_;
    all *= extent_[a] * (1 + 2.0 * margin / std::min<double>(edge, extent_[a]));
  }
  if (read <= all) return boxes;
  mark_all();
  return take(most);
}

}  // namespace gs::qnv::values
