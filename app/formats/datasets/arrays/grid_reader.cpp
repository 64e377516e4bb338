#include "app/formats/datasets/arrays/grid_reader.h"

#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace gs::app {

bool GridReader::read_stored(std::uint64_t z, std::span<std::byte> to) {
  const std::size_t number = size_of(type_), element = number * parts_;
  if (z >= size_[2] || to.size() != number * size_[0] * size_[1]) return false;
  if (slice_.along) slice_.first[*slice_.along] = z;
  std::size_t offset = 0;
  std::vector<std::uint64_t> counts;
  const auto slab = slabs_->read(slice_, offset, counts);
  if (!slab) return false;
  std::vector<std::size_t> steps(counts.size(), element);
  for (std::size_t i = counts.size(); i-- > 1;) steps[i - 1] = steps[i] * static_cast<std::size_t>(counts[i]);
  if (component_axis_)
    offset += steps[*component_axis_] * static_cast<std::size_t>(component_);
  else
    offset += number * static_cast<std::size_t>(component_);
  const std::size_t along_x = x_ ? steps[*x_] : element, along_y = y_ ? steps[*y_] : 0;
  std::byte* next = to.data();
  for (std::uint64_t y = 0; y < size_[1]; ++y) {
    const std::byte* from = slab->data() + offset + along_y * y;
    if (along_x == number) {
      std::memcpy(next, from, number * size_[0]);
      next += number * size_[0];
      continue;
    }
    for (std::uint64_t x = 0; x < size_[0]; ++x, from += along_x, next += number) std::memcpy(next, from, number);
  }
  return true;
}

bool GridReader::read_stored(const qnv::VoxelBox& box, std::span<std::byte> to) {
  const std::size_t number = size_of(type_), element = number * parts_;
  const std::size_t inside = component_axis_ ? 0 : number * static_cast<std::size_t>(component_);
  const std::array<std::optional<std::size_t>, 3> axes{x_, y_, slice_.along};
  std::vector<std::uint64_t> first = slice_.first, count(slice_.first.size(), 1);
  if (component_axis_) first[*component_axis_] = component_;
  std::vector<std::byte> part;
  // The axes of the array may be in any order.
  const auto choose = [&](const BoxPiece& piece) {
    for (std::size_t a = 0; a < 3; ++a)
      if (axes[a]) first[*axes[a]] = piece.voxels.first[a], count[*axes[a]] = piece.voxels.size[a];
  };
  if (slabs_->by_parts()) {
    constexpr std::size_t kMostTogether = 4096;
    std::vector<ArrayBox> boxes;
    (void)for_each_piece(box, chunk(), number, [&](const BoxPiece& piece) {
      choose(piece);
      boxes.push_back({first, count});
      if (boxes.size() < kMostTogether) return true;
      slabs_->prepare(slice_.array, boxes);
      boxes.clear();
      return true;
    });
    if (!boxes.empty()) slabs_->prepare(slice_.array, boxes);
  }
  const bool read = for_each_piece(box, chunk(), number, [&](const BoxPiece& piece) {
    choose(piece);
    if (!slabs_->read_part(slice_.array, first, count, part)) return false;
    std::vector<std::size_t> steps(count.size(), element);
    for (std::size_t i = count.size(); i-- > 1;) steps[i - 1] = steps[i] * static_cast<std::size_t>(count[i]);
    std::array<std::size_t, 3> along{};
    for (std::size_t a = 0; a < 3; ++a) along[a] = axes[a] ? steps[*axes[a]] * box.step[a] : 0;
    for (std::uint32_t z = 0; z < piece.samples[2]; ++z)
      for (std::uint32_t y = 0; y < piece.samples[1]; ++y) {
        const std::byte* from = part.data() + inside + z * along[2] + y * along[1];
        std::byte* next = to.data() + ((std::size_t{piece.at[2]} + z) * box.size[1] + piece.at[1] + y) *
                                          box.size[0] * number + piece.at[0] * number;
        for (std::uint32_t x = 0; x < piece.samples[0]; ++x, from += along[0], next += number)
          std::memcpy(next, from, number);
      }
    return true;
  });
  slabs_->put_aside();
  return read;
}

std::array<std::uint32_t, 3> GridReader::chunk() const {
  std::array<std::uint32_t, 3> edges{};
  const std::vector<std::uint64_t>& chunk = slabs_->chunk(slice_.array);
  const std::array<std::optional<std::size_t>, 3> axes{x_, y_, slice_.along};
  for (std::size_t a = 0; a < 3 && !chunk.empty(); ++a)
    edges[a] = axes[a] && *axes[a] < chunk.size()
                   ? static_cast<std::uint32_t>(std::clamp<std::uint64_t>(chunk[*axes[a]], 1, size_[a]))
                   : 1;
  return edges;
}

void GridReader::take_numbers(std::vector<double>& to) const {
  NumberType type = type_;
  if (spec_->reads_unsigned && type < NumberType::f32 && (static_cast<int>(type) & 1) != 0)
    type = static_cast<NumberType>(static_cast<int>(type) - 1);
  to = doubles_of(type, raw_);
  for (double& number : to) {
    const bool out = (spec_->least && number < *spec_->least) || (spec_->most && number > *spec_->most);
    if (out || std::ranges::find(spec_->missing, number) != spec_->missing.end())
      number = std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace gs::app
