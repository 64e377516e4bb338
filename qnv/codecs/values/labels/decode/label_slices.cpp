#include "qnv/codecs/values/labels/decode/label_slices.h"

#include "base/parallel.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/labels/decode/label_volume.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <utility>

namespace gs::qnv::values {

LabelLayout::LabelLayout(Extent extent) {
  for (int level = 0; level <= level_count(extent); ++level) {
    extents.push_back(low_extent(extent, level));
    orders.emplace_back(extents.back());
  }
}

bool LabelRunIndex::add(const LabelRun& run, std::size_t bytes, std::uint64_t offset) {
  if (run.level >= levels_.size()) return false;
  const std::uint64_t codes = layout_->orders[run.level].codes();
  if (run.first >= codes || run.count > codes - run.first) return false;
  levels_[run.level].places.push_back({run.first, offset, run.count, 0, 0, static_cast<std::uint16_t>(bytes)});
  return true;
}

namespace {

// Calls visit(first, last) with the corners of boxes of cubes, which may reach beyond the level. They have the codes
// from `begin` to `end`: codes with the same upper bits are a box.
template <class Visit>
void each_box(const CubeOrder& order, std::uint64_t begin, std::uint64_t end, Visit&& visit) {
  while (begin < end) {
    std::uint64_t size = begin == 0 ? std::uint64_t{1} << 63 : begin & (~begin + 1);
    while (size > end - begin) size /= 2;
    visit(order.place(begin), order.place(begin + size - 1));
    begin += size;
  }
}

// Sets the range of a run along z.
void measure_depth(const CubeOrder& order, LabelRunPlace& place) {
  place.low = order.cubes()[2];
  each_box(order, place.first, place.first + place.count, [&](const Extent& first, const Extent& last) {
    place.low = std::min(place.low, first[2]);
    place.high = std::max(place.high, std::min(last[2] + 1, order.cubes()[2]));
  });
}

// Reports whether the level has cubes with some codes.
bool has_cubes(const CubeOrder& order, std::uint64_t begin, std::uint64_t end) {
  bool any = false;
  each_box(order, begin, end, [&](const Extent& first, const Extent&) { any = any || order.has(first); });
  return any;
}

}  // namespace

void LabelRunIndex::finish() {
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    Level& level = levels_[i];
    const CubeOrder& order = layout_->orders[i];
    std::ranges::stable_sort(level.places, {}, &LabelRunPlace::first);
    std::uint64_t end = 0;
    level.whole = true;
    std::erase_if(level.places, [&](const LabelRunPlace& place) {
      if (place.first < end) return true;
      level.whole = level.whole && !has_cubes(order, end, place.first);
      end = place.first + place.count;
      return false;
    });
    level.whole = level.whole && !has_cubes(order, end, order.codes());
    for (LabelRunPlace& place : level.places) measure_depth(order, place);
  }
}

std::uint32_t LabelRunIndex::count() const {
  std::size_t sum = 0;
  for (const Level& level : levels_) sum += level.places.size();
  return static_cast<std::uint32_t>(sum);
}

namespace {

/// Decoder of the labels of a stream, some slices at once. One thread at a time.
class LabelSliceReader {
 public:
  LabelSliceReader(const ValueGrid& grid, LabelChain chain, ReadStream read)
      : grid_(grid), chain_(std::move(chain)), read_(std::move(read)) {
    constexpr std::uint64_t kSlabBytes = std::uint64_t{128} << 20;
    slice_ = std::size_t{grid.dimensions[0]} * grid.dimensions[1];
    const std::uint64_t slices = kSlabBytes / (slice_ * sizeof(std::uint32_t)) / kCubeEdge * kCubeEdge;
    depth_ = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(slices, kCubeEdge, std::uint64_t{1} << 20));
    // Later steps keep the cubes of the first one.
    const int top = level_count(grid.dimensions);
    while (from_ < top && !chain_.front()->is_whole(from_)) ++from_;
  }

  bool read(std::uint32_t z, std::span<std::byte> to) {
    if (z >= grid_.dimensions[2] || to.size() != slice_ * sizeof(std::uint32_t)) return false;
    if ((z < first_ || z - first_ >= count_) && !decode(z - z % depth_)) return false;
    std::memcpy(to.data(), slab_.data() + (z - first_) * slice_, to.size());
    return true;
  }

 private:
  bool decode(std::uint32_t first) {
    first_ = first;
    count_ = std::min(depth_, grid_.dimensions[2] - first);
    slab_.assign(slice_ * count_, background_label(grid_.palette, grid_.stored));
    failed_ = false;
    for (int level = from_; level >= 0; --level)
      for (const auto& step : chain_) paint(*step, level);
    if (failed_) {
      count_ = 0;
      return false;
    }
    parallel_for(count_, [this](std::size_t z) {
      label_numbers(std::span(slab_).subspan(z * slice_, slice_), grid_.palette, grid_.stored);
    });
    return true;
  }

  // Draws the runs of a level over coarser ones, and over those of the step before.
  void paint(const LabelRunIndex& index, int level) {
    const CubeOrder& order = index.layout().orders[static_cast<std::size_t>(level)];
    const Extent& extent = index.layout().extents[static_cast<std::size_t>(level)];
    const std::uint32_t edge = kCubeEdge << level;
    std::vector<const LabelRunPlace*> touched;
    for (const LabelRunPlace& place : index.places(level))
      if (std::uint64_t{place.low} * edge < first_ + count_ && std::uint64_t{place.high} * edge > first_)
        touched.push_back(&place);
    parallel_for(touched.size(), [&](std::size_t i) {
      std::vector<std::byte> payload(touched[i]->bytes);
      auto run = read_(touched[i]->offset, payload) ? parse_label_run(payload) : std::nullopt;
      if (run) (void)take_step(*run, order.codes());
      if (!run || run->first != touched[i]->first || run->count != touched[i]->count) {
        failed_ = true;
        return;
      }
      (void)decode_label_run(*run, order, extent, grid_.palette.size(),
                             [&](const Extent& cube, const CubeLabels& labels) { paint_cube(level, cube, labels); });
    });
  }

  void paint_cube(int level, const Extent& cube, const CubeLabels& labels) {
    Extent low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = cube[a] * kCubeEdge << level;
      high[a] = std::min(low[a] + (kCubeEdge << level), grid_.dimensions[a]);
    }
    for (std::uint32_t z = std::max(low[2], first_); z < std::min(high[2], first_ + count_); ++z)
      for (std::uint32_t y = low[1]; y < high[1]; ++y) {
        const std::uint32_t* const from =
            labels.labels + ((z - low[2]) >> level) * labels.slice + ((y - low[1]) >> level) * labels.row;
        std::uint32_t* const to = &slab_[(z - first_) * slice_ + std::size_t{y} * grid_.dimensions[0] + low[0]];
        for (std::uint32_t x = 0; x < high[0] - low[0]; ++x) to[x] = from[x >> level];
      }
  }

  const ValueGrid grid_;
  const LabelChain chain_;
  const ReadStream read_;
  std::size_t slice_ = 0;    // voxels
  std::uint32_t depth_ = 0;  // slices that are decoded at once
  int from_ = 0;             // coarsest level that matters
  std::uint32_t first_ = 0, count_ = 0;
  std::vector<std::uint32_t> slab_;  // stored numbers
  std::atomic<bool> failed_{false};
};

}  // namespace

std::shared_ptr<VolumeValues> label_slices(const ValueGrid& grid, const Description& about, LabelChain chain,
                                           ReadStream read, bool whole, std::optional<std::uint32_t> in_order) {
  auto made = described_labels(grid, about, 0);
  note_label_errors(grid, whole, in_order, *made);
  const auto slices = std::make_shared<LabelSliceReader>(grid, std::move(chain), std::move(read));
  made->source.read = [slices](std::uint32_t z, std::span<std::byte> to) { return slices->read(z, to); };
  return made;
}

}  // namespace gs::qnv::values
