#include "qnv/sampling/volume/gradients.h"

#include "qnv/base/found_vectors.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/label_vectors.h"
#include "qnv/sampling/volume/volume_window.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>

namespace gs::qnv {
namespace {

constexpr std::uint64_t kMaxVectors = std::uint64_t{1} << 31;

// Bits of a float >= 0, which sort like the floats. The first pass counts lengths by the upper 16 bits after the sign.
// If a bucket is too full, a second pass counts its lengths by the lower 15 bits.
using Key = std::uint32_t;
constexpr unsigned kLowerBits = 15;
constexpr std::size_t kUpperBuckets = std::size_t{1} << (31 - kLowerBits), kLowerBuckets = std::size_t{1} << kLowerBits;

/// Sums over the lengths of one block of rows.
struct Sums {
  double length = 0;
  float least = std::numeric_limits<float>::infinity(), most = -std::numeric_limits<float>::infinity();
};

using Counts = std::vector<std::uint64_t>;

/// Pool that lends a histogram to each thread, and adds up all histograms at the end.
class CountsPool {
 public:
  explicit CountsPool(std::size_t size) : size_(size) {}
  std::unique_ptr<Counts> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<Counts>(size_);
    auto counts = std::move(free_.back());
    free_.pop_back();
    return counts;
  }
  void give(std::unique_ptr<Counts> counts) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(counts));
  }
  [[nodiscard]] Counts total() const {
    Counts sum(size_);
    for (const auto& counts : free_)
      for (std::size_t i = 0; i < size_; ++i) sum[i] += (*counts)[i];
    return sum;
  }

 private:
  std::size_t size_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Counts>> free_;
};

/// Minimum length of the vectors in the result.
struct Cut {
  Key lowest = 1;                    // key of the minimum; shorter vectors are dropped
  std::uint64_t ties = kMaxVectors;  // maximum number of vectors with exactly that length; keeps the first voxels
};

class GradientEncoder {
 public:
  GradientEncoder(const VolumeSource& source, const GradientOptions& options, Progress* progress)
      : source_(source), layout_(source.layout), options_(options), progress_(progress) {
    const glm::dmat3 axes(layout_.axes[0], layout_.axes[1], layout_.axes[2]);
    to_world_ = glm::transpose(glm::inverse(axes));
    gaps_ = may_miss(layout_);
  }

  std::variant<Volume, VolumeError> run() {
    start("measuring");
    if (const auto problem = measure()) return *problem;
    if (!(all_.least <= all_.most)) return VolumeError{"every voxel of the volume is missing; expected values"};
    if (options_.range) std::tie(all_.least, all_.most) = *options_.range;
    FoundVectors found;
    if (wanted_ > 0) {
      if (const auto problem = find_cut()) return *problem;
      start("collecting");
      if (const auto problem = collect(found)) return *problem;
    }
    start("sorting");
    return volume_of(found);
  }

 private:
  void start(const char* stage) {
    if (!progress_) return;
    progress_->stage = stage;
    progress_->done = 0;
    progress_->total = layout_.dimensions[2];
  }

  /// Calls work(unit, y_begin, y_end, z) for blocks of rows that together cover all voxels, on all threads, one group
  /// of blocks at a time. Calls done(units) after each group, in order. The blocks do not depend on the number of
  /// threads.
  template <class Work, class Done>
  std::optional<VolumeError> sweep(Work&& work, Done&& done) {
    const std::uint32_t ny = layout_.dimensions[1], nz = layout_.dimensions[2];
    const std::uint32_t rows = block_rows(), blocks = (ny - 1) / rows + 1;
    VolumeWindow window(source_, options_.threads);
    const std::uint32_t batch = window.batch();
    for (std::uint64_t z = 0; z < nz; z += batch) {
      const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(batch, nz - z));
      const auto first = static_cast<std::int64_t>(z);
      if (!window.move_to(first - 1, first + count))
        return VolumeError{"the slices from " + std::to_string(z) + " onward cannot be read"};
      const std::size_t units = std::size_t{count} * blocks;
      const bool whole = parallel_for(
          units,
          [&](std::size_t unit) {
            const auto begin = static_cast<std::uint32_t>(unit % blocks) * rows;
            const std::uint32_t end = begin + std::min(rows, ny - begin);
            work(window, unit, begin, end, static_cast<std::uint32_t>(z + unit / blocks));
          },
          options_.threads, nullptr);
      if (!whole || (progress_ && progress_->cancelled)) return VolumeError{"cancelled"};
      done(units);
      if (progress_) progress_->done = z + count;
    }
    return std::nullopt;
  }

  /// Computes the gradient lengths of a row. Adds them to `sums` and `counts`.
  void measure_row(const GradientRow& row, float* lengths, Sums& sums, Counts& counts) const {
    constexpr std::uint32_t kLanes = 8;
    magnitudes(row, to_world_, gaps_, lengths);
    std::array<float, kLanes> least, most;
    std::array<double, kLanes> sum{};
    least.fill(sums.least);
    most.fill(sums.most);
    const auto add = [&](std::uint32_t x, std::uint32_t lane) {
      const float value = row.here[x];
      least[lane] = value < least[lane] ? value : least[lane];
      most[lane] = value > most[lane] ? value : most[lane];
      sum[lane] += static_cast<double>(lengths[x]);
    };
    std::uint32_t x = 0;
    for (; x + kLanes <= row.count; x += kLanes)
      for (std::uint32_t lane = 0; lane < kLanes; ++lane) add(x + lane, lane);
    for (; x < row.count; ++x) add(x, 0);
    for (std::uint32_t i = 0; i < row.count; ++i)
      if (lengths[i] > 0) ++counts[std::bit_cast<Key>(lengths[i]) >> kLowerBits];
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      sums.least = std::min(sums.least, least[lane]);
      sums.most = std::max(sums.most, most[lane]);
      sums.length += sum[lane];
    }
  }

  std::optional<VolumeError> measure() {
    CountsPool pool(kUpperBuckets);
    std::vector<Sums> sums;
    sums.resize(most_units());
    const auto problem = sweep(
        [&](const VolumeWindow& window, std::size_t unit, std::uint32_t begin, std::uint32_t end, std::uint32_t z) {
          auto counts = pool.take();
          std::vector<float> lengths(layout_.dimensions[0]);
          sums[unit] = {};
          for (std::uint32_t y = begin; y < end; ++y)
            measure_row(window.row(y, z), lengths.data(), sums[unit], *counts);
          pool.give(std::move(counts));
        },
        [&](std::size_t units) {
          for (std::size_t i = 0; i < units; ++i) {
            all_.length += sums[i].length;
            all_.least = std::min(all_.least, sums[i].least);
            all_.most = std::max(all_.most, sums[i].most);
          }
        });
    if (problem) return problem;
    counts_ = pool.total();
    std::uint64_t vectors = 0;
    for (const std::uint64_t count : counts_) vectors += count;
    const double share = std::round(options_.fraction * static_cast<double>(voxel_count(layout_)));
    wanted_ = std::min({vectors, options_.vectors, static_cast<std::uint64_t>(share)});
    return std::nullopt;
  }

  /// Returns the number of rows in one task of a thread.
  [[nodiscard]] std::uint32_t block_rows() const {
    constexpr std::uint32_t kBlock = 1u << 16;
    return std::max(1u, kBlock / layout_.dimensions[0]);
  }
  [[nodiscard]] std::size_t most_units() const {
    const std::size_t blocks = (layout_.dimensions[1] - 1) / block_rows() + 1;
    return VolumeWindow(source_, 1).batch() * blocks;
  }

  /// Finds the minimum length of the result. Refines this length to the last bit if too many vectors have a similar
  /// length to be sorted within about the memory of the result.
  std::optional<VolumeError> find_cut() {
    std::uint64_t above = 0;
    std::size_t bucket = kUpperBuckets - 1;
    while (above + counts_[bucket] < wanted_) above += counts_[bucket--];
    cut_.lowest = std::max<Key>(1, static_cast<Key>(bucket << kLowerBits));
    constexpr std::uint64_t kSpare = std::uint64_t{1} << 20;
    if (counts_[bucket] <= std::max(kSpare, wanted_ / 4)) return std::nullopt;

    start("measuring");
    CountsPool pool(kLowerBuckets);
    const auto problem = sweep(
        [&](const VolumeWindow& window, std::size_t, std::uint32_t begin, std::uint32_t end, std::uint32_t z) {
          auto counts = pool.take();
          std::vector<float> lengths(layout_.dimensions[0]);
          for (std::uint32_t y = begin; y < end; ++y) {
            magnitudes(window.row(y, z), to_world_, gaps_, lengths.data());
            for (const float length : lengths) {
              const Key key = std::bit_cast<Key>(length);
              if (key >> kLowerBits == bucket && key > 0) ++(*counts)[key & (kLowerBuckets - 1)];
            }
          }
          pool.give(std::move(counts));
        },
        [](std::size_t) {});
    if (problem) return problem;
    const Counts fine = pool.total();
    std::size_t low = kLowerBuckets - 1;
    // If the source changed after the first pass, it may have fewer such lengths. The search then ends at the bottom.
    while (low > 0 && above + fine[low] < wanted_) above += fine[low--];
    cut_.lowest = std::max<Key>(1, static_cast<Key>(bucket << kLowerBits | low));
    cut_.ties = wanted_ - std::min(wanted_, above);
    return std::nullopt;
  }

  void collect_row(const GradientRow& row, const float* lengths, std::uint32_t y, std::uint32_t z, std::uint64_t& ties,
                   std::vector<FoundVector>& to) const {
    const float lowest = std::bit_cast<float>(cut_.lowest);
    for (std::uint32_t x = 0; x < row.count; ++x) {
      if (!(lengths[x] >= lowest)) continue;
      if (lengths[x] == lowest) {
        if (ties == 0) continue;
        --ties;
      }
      const glm::dvec3 gradient = gradient_at(row, x, to_world_);
      to.push_back({{x, y, z}, std::bit_cast<Key>(lengths[x]), row.here[x], glm::vec3(glm::normalize(gradient))});
    }
  }

  std::optional<VolumeError> collect(FoundVectors& found) {
    std::vector<std::vector<FoundVector>> parts(most_units());
    std::uint64_t ties = cut_.ties;
    return sweep(
        [&](const VolumeWindow& window, std::size_t unit, std::uint32_t begin, std::uint32_t end, std::uint32_t z) {
          std::vector<float> lengths(layout_.dimensions[0]);
          std::uint64_t left = ties;
          for (std::uint32_t y = begin; y < end; ++y) {
            const GradientRow row = window.row(y, z);
            magnitudes(row, to_world_, gaps_, lengths.data());
            collect_row(row, lengths.data(), y, z, left, parts[unit]);
          }
        },
        [&](std::size_t units) {
          for (std::size_t i = 0; i < units && cut_.ties < kMaxVectors; ++i)
            std::erase_if(parts[i], [&](const FoundVector& entry) {
              return entry.key == cut_.lowest && (ties == 0 || ties-- == 0);
            });
          found.append(std::span(parts).first(units), options_.threads);
        });
  }

  std::variant<Volume, VolumeError> volume_of(const FoundVectors& found) const {
    const std::vector<FoundVectors::Entry> order = found.longest_first(options_.threads);
    const std::size_t count = std::min<std::size_t>(order.size(), wanted_);
    Volume volume;
    volume.description = description();
    const std::array<std::function<void()>, 4> resize = {
        [&] { volume.positions.resize(count); }, [&] { volume.normals.resize(count); },
        [&] { volume.weights.resize(count); }, [&] { volume.classes.resize(count); }};
    parallel_for(
        resize.size(), [&](std::size_t i) { resize[i](); }, options_.threads);
    const double least = all_.least, range = static_cast<double>(all_.most) - least;
    const double scale = range > 0 ? 255 / range : 0;
    constexpr std::size_t kPiece = 1u << 16, kAhead = 16;
    const bool whole =
        parallel_for((count + kPiece - 1) / kPiece,
                     [&](std::size_t piece) {
                       for (std::size_t i = piece * kPiece; i < std::min(count, (piece + 1) * kPiece); ++i) {
                         __builtin_prefetch(&found[order[std::min(i + kAhead, count - 1)].place]);
                         const FoundVector& entry = found[order[i].place];
                         volume.positions[i] = voxel_position(layout_, entry.voxel[0], entry.voxel[1], entry.voxel[2]);
                         volume.normals[i] = entry.normal;
                         volume.weights[i] = entry.length();
                         const double part = (static_cast<double>(entry.value) - least) * scale;
                         volume.classes[i] = static_cast<std::uint8_t>(std::clamp(part, 0.0, 255.0) + 0.5);
                       }
                     },
                     options_.threads);
    if (!whole || (progress_ && progress_->cancelled)) return VolumeError{"cancelled"};
    return volume;
  }

  [[nodiscard]] Description description() const {
    Description about = volume_description(layout_);
    about.total = all_.length;
    about.value_range = {all_.least, all_.most};
    about.transfer = default_transfer(all_.least, all_.most);
    return about;
  }

  const VolumeSource& source_;
  const VolumeLayout& layout_;
  const GradientOptions& options_;
  Progress* progress_;
  glm::dmat3 to_world_{1};
  bool gaps_ = false;
  Sums all_;
  Counts counts_;
  std::uint64_t wanted_ = 0;
  Cut cut_;
};

}  // namespace

std::variant<Volume, VolumeError> gradient_vectors(const VolumeSource& source, const GradientOptions& options,
                                                   Progress* progress) {
  if (const auto problem = check(source.layout)) return *problem;
  if (!source.read) return VolumeError{"the volume has no source of slices"};
  if (!(options.fraction >= 0 && options.fraction <= 1))
    return VolumeError{"the fraction of the vectors is " + std::to_string(options.fraction) + "; expected 0 to 1"};
  if (options.vectors > kMaxVectors)
    return VolumeError{std::to_string(options.vectors) + " vectors were requested; expected at most " +
                       std::to_string(kMaxVectors)};
  if (source.layout.labels) return label_vectors(source, options, progress);
  auto made = GradientEncoder(source, options, progress).run();
  if (auto* const volume = std::get_if<Volume>(&made); volume && has_colors(source)) {
    color_vectors(source, *volume);
    volume->description.transfer = color_transfer();
  }
  return made;
}

std::vector<TransferPoint> default_transfer(float least, float most) {
  struct Step {
    float place;
    Rgb8 color;
    float opacity;
  };
  constexpr std::array<Step, 6> kSteps = {{{0.0f, {70, 30, 20}, 0.0f},
                                           {0.12f, {150, 70, 45}, 0.0f},
                                           {0.3f, {205, 130, 95}, 0.12f},
                                           {0.5f, {232, 190, 140}, 0.4f},
                                           {0.75f, {250, 240, 220}, 0.75f},
                                           {1.0f, {255, 255, 255}, 0.95f}}};
  const double range = static_cast<double>(most) - least;
  const double zero = range > 0 && least < 0 ? -static_cast<double>(least) / range : 0;
  const auto start = static_cast<float>(zero < 0.5 ? zero : 0);
  std::vector<TransferPoint> points;
  if (start > 0) points.push_back({0, kSteps[0].color, 0});
  for (const Step& step : kSteps) points.push_back({start + (1 - start) * step.place, step.color, step.opacity});
  points.back().value = 1;
  return points;
}

Box voxel_box(const VolumeLayout& layout) {
  Box box;
  const auto [nx, ny, nz] = layout.dimensions;
  for (const double x : {0.0, nx - 1.0})
    for (const double y : {0.0, ny - 1.0})
      for (const double z : {0.0, nz - 1.0}) box.add(voxel_position(layout, x, y, z));
  return box;
}

Description volume_description(const VolumeLayout& layout) {
  Description about;
  about.two_sided = true;
  about.origin = layout.base;
  about.box = voxel_box(layout);
  about.spacing = std::min({glm::length(layout.axes[0]), glm::length(layout.axes[1]), glm::length(layout.axes[2])});
  about.metadata = layout.metadata;
  return about;
}

}  // namespace gs::qnv
