#include "qnv/sampling/volume/volume_window.h"

#include <algorithm>

namespace gs::qnv {

std::uint32_t VolumeWindow::batch() const {
  constexpr std::size_t kVoxels = std::size_t{1} << 21;
  // Slices of a few voxels go in larger batches, because each batch starts threads.
  constexpr std::size_t kMax = 64, kSmallBatch = std::size_t{1} << 16;
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(
      kVoxels / slice_voxels(source_.layout), 1, std::max(kMax, kSmallBatch / slice_voxels(source_.layout))));
}

bool VolumeWindow::move_to(std::int64_t first, std::int64_t last) {
  first = std::max<std::int64_t>(first, 0);
  last = std::min<std::int64_t>(last, std::int64_t{source_.layout.dimensions[2]} - 1);
  if (last < first) return true;
  const auto needed = static_cast<std::size_t>(last - first + 1);
  if (slots_.size() < needed) {
    slots_.clear();
    slots_.resize(needed);
  }
  const std::size_t voxels = slice_voxels(source_.layout);
  const std::size_t bytes = voxels * size_of(source_.layout.type);
  // Alternates between two steps on batches of limited size: one thread reads, then all threads convert.
  const std::size_t turn = std::max<std::size_t>(1, (std::size_t{16} << 20) / bytes);
  std::vector<Slot*> fresh;
  for (std::int64_t z = first; z <= last; ++z) {
    Slot& slot = slots_[static_cast<std::size_t>(z) % slots_.size()];
    if (slot.z != z) {
      slot.z = -1;
      stored_.resize(std::max(stored_.size(), (fresh.size() + 1) * bytes));
      if (!source_.read(static_cast<std::uint32_t>(z), std::span(stored_).subspan(fresh.size() * bytes, bytes)))
        return false;
      slot.values.resize(voxels);
      slot.z = z;
      fresh.push_back(&slot);
    }
    if (fresh.size() < turn && z < last) continue;
    constexpr std::size_t kPiece = std::size_t{1} << 18;
    const std::size_t pieces = (voxels + kPiece - 1) / kPiece;
    parallel_for(
        fresh.size() * pieces,
        [&](std::size_t i) {
          const std::size_t begin = i % pieces * kPiece, count = std::min(kPiece, voxels - begin);
          const std::size_t size = size_of(source_.layout.type);
          values_of(source_.layout, std::span(stored_).subspan(i / pieces * bytes + begin * size, count * size),
                    std::span(fresh[i / pieces]->values).subspan(begin, count));
        },
        threads_);
    fresh.clear();
  }
  return true;
}

GradientRow VolumeWindow::row(std::uint32_t y, std::uint32_t z) const {
  const auto [nx, ny, nz] = source_.layout.dimensions;
  const float* here = slice(z) + std::size_t{y} * nx;
  const std::size_t offset = std::size_t{y} * nx;
  GradientRow row;
  row.here = here;
  row.before[0] = y > 0 ? here - nx : here;
  row.after[0] = y + 1 < ny ? here + nx : here;
  row.before[1] = z > 0 ? slice(z - 1) + offset : here;
  row.after[1] = z + 1 < nz ? slice(z + 1) + offset : here;
  row.factor[0] = y > 0 && y + 1 < ny ? 0.5 : 1.0;
  row.factor[1] = z > 0 && z + 1 < nz ? 0.5 : 1.0;
  row.count = nx;
  return row;
}

}  // namespace gs::qnv
