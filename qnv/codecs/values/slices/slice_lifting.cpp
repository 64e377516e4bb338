#include "qnv/codecs/values/slices/slice_lifting.h"

#include "qnv/codecs/values/lifting_kernel.h"

#include <algorithm>
#include <cstring>

namespace gs::qnv::values {

namespace {

// Row of a transformed slice that holds row y of ny.
std::size_t row_in_bands(std::uint32_t y, std::uint32_t ny) { return y % 2 == 0 ? y / 2 : (ny + 1) / 2 + y / 2; }

// Makes the lifting operations along y that row y permits.
void lift_next_row(LiftOrder& order, std::uint32_t y, SliceRows bands, std::uint32_t nx, std::uint32_t ny, bool undo,
                   SliceScratch& scratch) {
  const auto row = [&](std::uint32_t at) { return bands.first + row_in_bands(at, ny) * bands.stride; };
  scratch.operations.clear();
  order.advance(y + 1, scratch.operations);
  for (const LiftOperation& one : scratch.operations)
    lift(row(one.target), row(one.before), row(one.after), nx, one.step, undo);
}

}  // namespace

void copy_slice(SliceRows from, SliceRows to, const Extent& size) {
  for (std::uint32_t y = 0; y < size[1]; ++y)
    std::memcpy(to.first + y * to.stride, from.first + y * from.stride, size[0] * sizeof(std::int32_t));
}

LiftOrder::LiftOrder(std::uint32_t samples, bool undo) : samples_(samples), undo_(undo) {
  for (std::uint32_t i = 0; i < 4; ++i) next_[i] = (i % 2 == 0) != undo ? 1 : 0;
}

void LiftOrder::advance(std::uint32_t ready, std::vector<LiftOperation>& operations) {
  ready_ = std::min(ready, samples_);
  if (samples_ < 2) return;
  for (std::uint32_t k = 0; k < 4; ++k)
    for (std::uint32_t& i = next_[k]; i < samples_; i += 2) {
      const std::uint32_t before = i > 0 ? i - 1 : 1, after = i + 1 < samples_ ? i + 1 : i - 1;
      const std::uint32_t needed = std::max(before, after);
      if (k == 0 ? std::max(needed, i) >= ready_ : needed >= next_[k - 1]) break;
      operations.push_back({i, before, after, undo_ ? 3 - k : k});
    }
}

std::uint32_t LiftOrder::finished() const { return samples_ < 2 ? ready_ : std::min({next_[2], next_[3], samples_}); }

std::uint32_t LiftOrder::released() const {
  if (samples_ < 2 || next_[3] >= samples_) return finished();
  return std::min(finished(), next_[3] > 0 ? next_[3] - 1 : 0);
}

void split_slice(SliceRows from, SliceRows bands, std::uint32_t nx, std::uint32_t ny, SliceScratch& scratch) {
  LiftOrder order(ny, false);
  for (std::uint32_t y = 0; y < ny; ++y) {
    split_line(from.first + y * from.stride, bands.first + row_in_bands(y, ny) * bands.stride, nx, scratch.line);
    lift_next_row(order, y, bands, nx, ny, false, scratch);
  }
}

void join_slice(SliceRows bands, SliceRows to, std::uint32_t nx, std::uint32_t ny, SliceScratch& scratch) {
  LiftOrder order(ny, true);
  std::uint32_t done = 0;
  for (std::uint32_t y = 0; y < ny; ++y) {
    lift_next_row(order, y, bands, nx, ny, true, scratch);
    for (; done < order.finished(); ++done)
      join_line(bands.first + row_in_bands(done, ny) * bands.stride, to.first + done * to.stride, nx, scratch.line);
  }
}

}  // namespace gs::qnv::values
