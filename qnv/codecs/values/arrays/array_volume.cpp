#include "qnv/codecs/values/arrays/array_volume.h"

#include "base/free_memory.h"
#include "qnv/codecs/values/bricks/brick_choice.h"
#include "qnv/codecs/values/bricks/brick_merge.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <variant>

namespace gs::qnv {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostArrayViews = 16;
// Bricks are first shown after kFirstBricks; later only after kMoreBricks and with half as many more bricks.
constexpr std::chrono::milliseconds kFirstBricks{150}, kMoreBricks{1000};
constexpr std::size_t kBrickGrowth = 2;
// Reads that take longer than kLongRead shrink the next group of bricks; reads below kShortRead grow it.
constexpr std::chrono::milliseconds kLongRead{700}, kShortRead{200};

/// Returns the source of samples in memory.
VolumeSource source_in_memory(const VolumeLayout& layout, std::shared_ptr<const std::vector<float>> samples) {
  VolumeSource source;
  source.layout = layout;
  const std::size_t slice = slice_voxels(layout);
  source.read = [samples = std::move(samples), slice, count = layout.dimensions[2]](std::uint32_t z,
                                                                                  std::span<std::byte> to) {
    if (z >= count || to.size() != slice * sizeof(float)) return false;
    std::memcpy(to.data(), samples->data() + z * slice, to.size());
    return true;
  };
  return source;
}

/// Returns what the viewer knows about the values of an overview. `level` is its level.
std::shared_ptr<const VolumeValues> overview_values(const VolumeSource& original, VolumeSource overview, int level,
                                                    std::span<const float> samples) {
  auto values = std::make_shared<VolumeValues>();
  const VolumeLayout& layout = original.layout;
  float least = std::numeric_limits<float>::infinity(), most = -least;
  for (const float value : samples) {
    least = std::min(least, value == value ? value : least);
    most = std::max(most, value == value ? value : most);
  }
  if (least <= most) values->range = {least, most};
  values->level = level;
  values->whole = layout.dimensions;
  values->stored = layout.type;
  values->slope = layout.slope;
  values->intercept = layout.intercept;
  values->missing = layout.missing;
  values->bytes = samples.size_bytes();
  values->source = std::move(overview);
  return values;
}

/// Returns a finer part of the values. The voxels of the file itself are exact.
ValueBrick part_of_array(const values::Brick& brick, const values::BrickLayout& layout) {
  ValueBrick part;
  part.level = brick.name.level;
  part.first = brick.samples->box.first;
  part.size = brick.samples->box.size;
  const values::SampleBox core = layout.core(brick.name);
  part.core_first = core.first;
  part.core_size = core.size;
  for (std::size_t a = 0; a < 3; ++a) {
    int steps = 0;  // an axis of one voxel stays as it is
    for (int level = part.level; level < layout.base(); ++level) steps += layout.extent(level)[a] > 1 ? 1 : 0;
    part.steps[a] = std::ldexp(1.0, -steps);
  }
  part.type = VoxelType::f32;
  if (part.level == 0) {
    constexpr std::uint32_t kEdge = ValueBrick::kErrorEdge;
    part.error = 0.0f;
    part.bounded = std::make_shared<const std::vector<std::uint8_t>>(
        std::size_t{(part.size[0] - 1) / kEdge + 1} * ((part.size[1] - 1) / kEdge + 1) *
            ((part.size[2] - 1) / kEdge + 1),
        std::uint8_t{1});
  }
  part.samples = {brick.samples, &brick.samples->samples};
  return part;
}

int base_of(const VolumeSource& source, std::size_t most_vectors) {
  const values::Extent& extent = source.layout.dimensions;
  return std::min(values::level_for(extent, most_vectors), values::level_count(extent));
}

/// Returns the distance of a point from a box.
float distance_of(const glm::vec3& point, const Box& box) {
  return glm::distance(point, glm::clamp(point, box.lower, box.upper));
}

/// Chooses the bricks of views. Views from outside have about equal voxels everywhere. If only some bricks of a level
/// fit, such views get none of them, because single bricks would be visible as patches.
std::vector<values::BrickName> bricks_of_array(const values::BrickChoice& choice, const Box& box) {
  constexpr std::size_t kMore = 8;
  std::vector<values::BrickName> chosen = values::choose_bricks(choice);
  const float size = glm::distance(box.lower, box.upper);
  const bool outside = std::ranges::all_of(choice.views, [&](const LodView& view) {
    const auto none = [](const glm::vec4& plane) { return plane == glm::vec4(0); };
    return distance_of(view.eye, box) > size / 2 && std::ranges::all_of(view.volume.slices, none);
  });
  if (!outside || chosen.empty()) return chosen;
  values::BrickChoice more = choice;
  more.most_bytes = choice.most_bytes > ~std::size_t{0} / kMore ? ~std::size_t{0} : kMore * choice.most_bytes;
  std::vector<std::size_t> missing(choice.levels.size());
  // Bricks without visible vectors come after those of finer levels.
  const auto visible = [&](const values::BrickName& name) {
    return std::ranges::any_of(choice.views, [&](const LodView& view) {
      return choice.shares.visible(name, view.volume.hidden_classes);
    });
  };
  for (const values::BrickName& name : values::choose_bricks(more))
    if (visible(name)) ++missing[static_cast<std::size_t>(name.level)];
  for (const values::BrickName& name : chosen)
    if (visible(name)) --missing[static_cast<std::size_t>(name.level)];
  int finest = choice.layout.base();
  while (finest > 0 && missing[static_cast<std::size_t>(finest - 1)] == 0) --finest;
  std::erase_if(chosen, [&](const values::BrickName& name) {
    const Box part = values::brick_box(choice.layout, name, choice.levels[static_cast<std::size_t>(name.level)]);
    const bool pointed = std::ranges::any_of(choice.views, [&](const LodView& view) {
      return std::ranges::any_of(view.volume.points,
                                 [&](const auto& point) { return point && distance_of(*point, part) == 0; });
    });
    return name.level < finest && !pointed;
  });
  return chosen;
}

}  // namespace

ArrayVolume::ArrayVolume(VolumeSource source, const BrickLimits& limits, std::chrono::milliseconds patience)
    : limits_(limits),
      patience_(patience),
      levels_(std::move(source), base_of(source, limits.base_vectors)),
      layout_(levels_.extent(), levels_.base()),
      overview_(levels_),
      bricks_(levels_, layout_) {
  return_large_pieces();
}

ArrayVolume::~ArrayVolume() {
  stop_ = true;
  if (running_.valid()) running_.wait();
}

bool ArrayVolume::suits(const VolumeSource& source, std::size_t most_vectors) {
  constexpr std::uint32_t kMostOfAxis = std::uint32_t{1} << 31;  // so that sums of places have 32 bits
  return !source.layout.labels && !source.layout.colors && !check(source.layout) &&
         std::ranges::all_of(source.layout.dimensions, [](std::uint32_t n) { return n <= kMostOfAxis; }) &&
         base_of(source, most_vectors) > 0;
}

bool ArrayVolume::read_overview(std::chrono::milliseconds patience, const std::function<bool()>& stop) {
  const Clock::time_point end = Clock::now() + patience;
  {
    const std::lock_guard lock(mutex_);
    if (!began_) began_ = Clock::now();
  }
  (void)overview_.read([&] { return Clock::now() >= end || (stop && stop()); });
  return show_overview();
}

bool ArrayVolume::restore_overview(std::vector<float> samples) {
  return overview_.restore(std::move(samples));
}

bool ArrayVolume::has_overview() const { return overview_.complete(); }
bool ArrayVolume::has_whole_overview() const { return overview_.complete() && overview_.good(); }
double ArrayVolume::progress() const { return overview_.progress(); }

// Makes the vectors of the overview. Returns false if it has no values so far.
bool ArrayVolume::show_overview() {
  auto base = std::make_shared<Base>();
  auto samples = std::make_shared<const std::vector<float>>(overview_.samples());
  VolumeSource overview = source_in_memory(levels_.layouts().back(), samples);
  GradientOptions options;
  options.vectors = limits_.base_vectors;
  auto found = gradient_vectors(overview, options);
  auto* const volume = std::get_if<Volume>(&found);
  if (!volume) return false;
  volume->values = overview_values(levels_.source(), std::move(overview), levels_.base(), *samples);
  base->shares = values::VectorShares(*volume, levels_.layouts().back(), layout_.base());
  base->volume = std::make_shared<const Volume>(std::move(*volume));
  base->samples = std::move(samples);
  // The overview does not change any more, and lives as long as this object.
  if (overview_.complete() && overview_.good() && overview_.level() < levels_.base())
    base->known = {overview_.level(), {std::shared_ptr<void>(), &overview_.kept()}};
  const std::lock_guard lock(mutex_);
  base->version = base_ ? base_->version + 1 : 1;
  base_ = std::move(base);
  stale_ = true;
  known_part_ = overview_.progress();
  // Shows the overview at once in views without bricks.
  if (!shown_ || views_.empty() || statistics_.shown == 0) {
    shown_ = base_->volume;
    ++revision_;
  }
  return true;
}

bool ArrayVolume::may_read_bricks(const LodView& view) const {
  constexpr double kNoLargeGaps = 0.25;
  const auto chosen = [](const glm::vec4& plane) { return plane != glm::vec4(0); };
  const auto there = [](const auto& point) { return point.has_value(); };
  return known_part_ >= kNoLargeGaps || !began_ || Clock::now() - *began_ >= kOverviewFirst ||
         view.most_decoded == 0 || std::ranges::any_of(view.volume.slices, chosen) ||
         std::ranges::any_of(view.volume.points, there);
}

std::shared_ptr<const Volume> ArrayVolume::latest() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

std::shared_ptr<const Volume> ArrayVolume::overview() const {
  const std::lock_guard lock(mutex_);
  return base_ ? base_->volume : nullptr;
}

std::uint64_t ArrayVolume::revision() const {
  const std::lock_guard lock(mutex_);
  return 2 * revision_ + (!working_ && stale_ ? 1 : 0);
}

BrickStatistics ArrayVolume::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

std::string ArrayVolume::trouble() const {
  const std::lock_guard lock(mutex_);
  return failures_ == 0 ? std::string() : std::to_string(failures_) + " parts of the volume cannot be read";
}

// Makes the volume to draw. With `with_values`, it keeps the samples of its bricks in memory while it is drawn.
std::shared_ptr<const Volume> ArrayVolume::merged(const Base& base, std::span<const values::BrickName> ready,
                                                  bool with_values) const {
  if (ready.empty()) return base.volume;
  const auto find = [this](const values::BrickName& name) { return bricks_.find(name); };
  auto made =
      std::make_shared<Volume>(values::merge_bricks(*base.volume, layout_, levels_.layouts(), ready, find));
  auto values = std::make_shared<VolumeValues>(*base.volume->values);
  for (const values::BrickName& name : with_values ? ready : std::span<const values::BrickName>())
    values->bricks.push_back(part_of_array(*bricks_.find(name), layout_));
  std::ranges::stable_sort(values->bricks, {}, &ValueBrick::level);
  values->bytes += bricks_.bytes();
  made->values = std::move(values);
  return made;
}

// Shows the bricks that were read so far.
void ArrayVolume::publish(const Base& base, const std::vector<LodView>& views) {
  const std::vector<values::BrickName> ready = bricks_.finish(*base.samples, base.version, base.shares);
  const bool with_values = std::ranges::any_of(views, [](const LodView& view) { return view.volume.values; });
  auto made = merged(base, ready, with_values);
  const std::lock_guard lock(mutex_);
  shown_ = std::move(made);
  statistics_.bricks = bricks_.count();
  statistics_.shown = ready.size();
  statistics_.bytes = bricks_.bytes();
  statistics_.base = statistics_.finest = layout_.base();
  for (const values::BrickName& name : ready) statistics_.finest = std::min(statistics_.finest, name.level);
  failures_ = bricks_.failures();
  ++revision_;
}

// Reads the bricks of the views, and begins again when these change. `beside` shows the first bricks early.
void ArrayVolume::work(bool beside) {
  const Clock::time_point end = Clock::now() + patience_;
  std::vector<values::BrickName> last;
  std::uint64_t last_base = 0;
  bool last_values = false;
  for (;;) {
    std::unique_lock lock(mutex_);
    if (stop_ || !stale_ || !base_) {
      working_ = false;
      ++revision_;
      break;
    }
    stale_ = false;
    const std::shared_ptr<const Base> base = base_;
    const std::vector<LodView> views = views_;
    lock.unlock();
    std::vector<values::BrickName> chosen =
        bricks_of_array({layout_, levels_.layouts(), base->shares, views, limits_.brick_bytes},
                        base->volume->description.box);
    const bool with_values = std::ranges::any_of(views, [](const LodView& view) { return view.volume.values; });
    bool changed = chosen != last || base->version != last_base || with_values != last_values;
    last = chosen;
    last_base = base->version;
    last_values = with_values;
    bricks_.choose(std::move(chosen), base->shares, limits_.brick_bytes);
    Clock::time_point shown = Clock::now();
    std::chrono::milliseconds pause = kFirstBricks;
    std::size_t read = 0, read_then = 0;
    const auto ends = [&] { return stop_ || (beside ? stale_.load() : Clock::now() >= end); };
    for (auto group = bricks_.next(together_); !group.empty() && !ends();
         group = bricks_.next(together_)) {
      const Clock::time_point begin = Clock::now();
      bricks_.read(group, base->known);
      // A view that moves waits for the bricks that are being read.
      const auto time = Clock::now() - begin;
      if (beside && time > kLongRead) together_ = std::max<std::size_t>(together_ / 2, 1);
      if (time < kShortRead) together_ = std::min<std::size_t>(together_ * 2, kMostTogether);
      read += group.size();
      changed = true;
      if (!beside || Clock::now() - shown < pause || read < read_then + read_then / kBrickGrowth) continue;
      publish(*base, views);
      read_then = read;
      shown = Clock::now();
      pause = kMoreBricks;
      changed = false;
    }
    if (changed && !stop_) publish(*base, views);
  }
  // Each choice replaces bricks and vectors.
  return_freed_memory();
}

std::shared_ptr<const Volume> ArrayVolume::cut(const LodView& view, bool& pending) {
  std::unique_lock lock(mutex_);
  const auto same = std::ranges::find(views_, view.viewport, &LodView::viewport);
  if (same == views_.end()) {
    if (views_.size() == kMostArrayViews) views_.erase(views_.begin());
    views_.push_back(view);
    stale_ = true;
  } else if (*same != view) {
    *same = view;
    stale_ = true;
  }
  const bool waits = view.most_decoded == 0;
  if (waits && working_) {
    lock.unlock();
    running_.wait();
    lock.lock();
  }
  if (!working_ && stale_ && base_ && may_read_bricks(view)) {
    working_ = true;
    if (waits) {
      // The former volume is not drawn while this thread waits for the next one.
      shown_.reset();
      lock.unlock();
      work(false);
      lock.lock();
      if (!shown_) shown_ = base_->volume;
    } else {
      running_ = std::async(std::launch::async, [this] { work(true); });
    }
  }
  pending = pending || working_;
  return shown_;
}

}  // namespace gs::qnv
