#include "qnv/codecs/values/labels/encode/label_stream.h"

#include "qnv/codecs/values/encode/write_values.h"
#include "qnv/codecs/values/labels/encode/label_pyramid.h"
#include "qnv/codecs/values/labels/encode/label_uses.h"
#include "qnv/codecs/values/labels/encode/stored_labels.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/label_vectors.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>

namespace gs::qnv {
namespace {

using values::Extent;
using Runs = std::vector<values::StoredLabelRun>;

/// Encoder of the runs of all levels of all steps. Each rank encodes some segments.
class PyramidEncoder {
 public:
  PyramidEncoder(const values::LabelPyramid& pyramid, values::SharedStore& store, Ranks& ranks, unsigned threads,
                 Progress* progress)
      : pyramid_(pyramid), store_(store), ranks_(ranks), threads_(threads), progress_(progress) {
    for (const values::StoredLabels& level : pyramid.steps.front()) orders_.emplace_back(level.extent());
    sums_.assign(orders_.size(), 0);
  }

  /// Returns the runs of all ranks in the order of the stream, or the error of a rank. Collective.
  std::variant<Runs, EncodeError> encode() {
    const std::size_t levels = orders_.size(), steps = pyramid_.steps.size();
    std::vector<Segment> segments;
    for (std::size_t step = 0; step < steps; ++step)
      for (std::size_t level = 0; level < levels; ++level)
        for (std::uint64_t first = 0; first < orders_[level].codes(); first += values::kSegmentCodes)
          segments.push_back({step, level, first / values::kSegmentCodes});
    const RankShare share = share_of(ranks_, segments.size());
    if (progress_) {
      progress_->stage = "encoding";
      progress_->done = 0;
      progress_->total = share.size();
    }
    std::vector<Runs> made(static_cast<std::size_t>(share.size()));
    (void)parallel_for(
        made.size(),
        [&](std::size_t i) {
          made[i] = runs_of(segments[static_cast<std::size_t>(share.first) + i]);
          if (progress_) ++progress_->done;
        },
        threads_, progress_);
    Runs own;
    for (const Runs& some : made) own.insert(own.end(), some.begin(), some.end());
    store_.publish();
    if (auto problem = agree(ranks_, failure())) return std::move(*problem);
    std::vector<std::vector<Runs>> all(steps, std::vector<Runs>(levels));
    for (const values::StoredLabelRun& run : gather_records(ranks_, std::span<const values::StoredLabelRun>(own)))
      all[run.step][run.level].push_back(run);
    for (std::size_t step = 0; step < steps; ++step)
      (void)values::count_corrected(pyramid_.steps[step], orders_, all[step], sums_, ranks_, threads_, progress_);
    if (auto problem = agree(ranks_, failure())) return std::move(*problem);
    // Order the runs by level (coarse first), then by step, then by corrected voxels per byte.
    Runs runs;
    for (std::size_t level = levels; level-- > 0;)
      for (std::vector<Runs>& of_step : all) {
        std::ranges::stable_sort(of_step[level], std::greater{}, [](const values::StoredLabelRun& run) {
          return static_cast<double>(run.corrected) / static_cast<double>(run.bytes + kChunkHeaderBytes);
        });
        runs.insert(runs.end(), of_step[level].begin(), of_step[level].end());
      }
    return runs;
  }
  /// Returns the numbers of voxels of all steps that a level corrects, by level.
  [[nodiscard]] std::span<const std::int64_t> sums() const { return sums_; }

 private:
  struct Segment {
    std::size_t step, level;
    std::uint64_t number;  // index in its level
  };

  [[nodiscard]] std::optional<EncodeError> failure() const {
    if (is_cancelled(progress_)) return EncodeError{"cancelled"};
    if (store_.failed()) return EncodeError{"cannot keep the labels: " + store_.problem()};
    return std::nullopt;
  }

  // Encodes a segment. Keeps equal cubes of the previous step if that takes fewer bytes.
  Runs runs_of(const Segment& segment) {
    Runs runs = runs_of(segment, nullptr);
    if (segment.step % kChainSteps == 0) return runs;
    values::LabelTiles before(pyramid_.steps[segment.step - 1][segment.level]);
    Runs kept = runs_of(segment, &before);
    const auto size = [](const Runs& of) {
      std::uint64_t bytes = 0;
      for (const values::StoredLabelRun& run : of) bytes += run.bytes + kChunkHeaderBytes;
      return bytes;
    };
    return size(kept) < size(runs) ? kept : runs;
  }

  Runs runs_of(const Segment& segment, values::LabelCubes* before) {
    // Clang 14 does not capture structured bindings.
    const std::size_t step = segment.step, level = segment.level;
    const auto number = segment.number;
    const values::StoredLabels& labels = pyramid_.steps[step][level];
    const values::CubeOrder& order = orders_[level];
    const Extent volume = pyramid_.steps.front().front().extent();
    values::LabelTiles tiles(labels);
    Runs runs;
    const auto take = [&](values::LabelRun&& run) {
      values::StoredLabelRun stored;
      stored.level = run.level;
      stored.step = static_cast<std::uint16_t>(step);
      stored.first = run.first;
      stored.count = run.count;
      stored.low = labels.extent();
      for (std::uint64_t code = run.first; code < run.first + run.count; ++code) {
        const Extent cube = order.place(code);
        if (!order.has(cube)) continue;
        for (std::size_t a = 0; a < 3; ++a) {
          stored.low[a] = std::min(stored.low[a], cube[a] * values::kCubeEdge);
          stored.high[a] = std::max(stored.high[a], cube[a] * values::kCubeEdge + values::kCubeEdge);
        }
      }
      for (std::size_t a = 0; a < 3; ++a) {
        stored.low[a] <<= level;
        stored.high[a] =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(std::uint64_t{stored.high[a]} << level, volume[a]));
      }
      run.first += step * order.codes();
      const std::vector<std::byte> payload = values::pack(run);
      stored.bytes = static_cast<std::uint16_t>(payload.size());
      const auto offset = store_.append(payload);
      stored.offset = offset.value_or(0);
      runs.push_back(stored);
      return offset && !is_cancelled(progress_);
    };
    values::encode_label_runs(tiles, order, number, pyramid_.palette->size(), static_cast<int>(level), take, before);
    return runs;
  }

  const values::LabelPyramid& pyramid_;
  values::SharedStore& store_;
  Ranks& ranks_;
  unsigned threads_;
  Progress* progress_;
  std::vector<values::CubeOrder> orders_;  // by level
  std::vector<std::int64_t> sums_;         // by level
};

/// Chunks of a stream of labels.
class LabelChunks final : public ChunkList {
 public:
  LabelChunks(const VolumeLayout& layout, const values::SharedStore& store,
              std::span<const values::StoredLabelRun> runs, bool series)
      : layout_(layout), store_(store), runs_(runs), series_(series) {}
  [[nodiscard]] std::size_t size() const override { return runs_.size(); }
  [[nodiscard]] std::optional<OutgoingChunk> chunk(std::size_t i) const override {
    const values::StoredLabelRun& run = runs_[i];
    OutgoingChunk chunk;
    chunk.type = ChunkType::labels;
    chunk.payload.resize(run.bytes);
    if (!store_.read(run.offset, chunk.payload)) return std::nullopt;
    chunk.gain = static_cast<double>(std::max<std::int64_t>(run.corrected, 0));
    chunk.entry.parent = series_ ? run.step : 0xffffffff;
    chunk.entry.level = run.level;
    double voxels = 1;
    for (std::size_t a = 0; a < 3; ++a) voxels *= run.high[a] - run.low[a];
    if (run.level == 0) chunk.entry.vectors = static_cast<std::uint32_t>(std::min(voxels * kShownFraction, 1e9));
    for (unsigned corner = 0; corner < 8; ++corner) {
      const auto end = [&](std::size_t a) {
        return (corner >> a & 1) != 0 ? run.high[a] - 1.0 : static_cast<double>(run.low[a]);
      };
      chunk.entry.box.add(voxel_position(layout_, end(0), end(1), end(2)));
    }
    return chunk;
  }

 private:
  const VolumeLayout& layout_;
  const values::SharedStore& store_;
  std::span<const values::StoredLabelRun> runs_;
  bool series_;
};

// Returns a share of voxels, rounded up, so that only exact labels have no error.
float share_of(std::int64_t wrong, std::uint64_t voxels) {
  const double exact = static_cast<double>(wrong) / static_cast<double>(voxels);
  const auto share = static_cast<float>(exact);
  return static_cast<double>(share) < exact ? std::nextafter(share, 2.0f) : share;
}

// Returns the shares of wrong labels after some sizes, and after each level.
std::vector<ValueError> shares_of(std::span<const values::StoredLabelRun> runs, std::uint64_t voxels) {
  constexpr std::size_t kSteps = 40;
  std::vector<ValueError> errors;
  std::int64_t right = 0;
  std::size_t bytes = 0, all = 0, next = 0;
  for (const values::StoredLabelRun& run : runs) all += run.bytes;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    right += runs[i].corrected;
    bytes += runs[i].bytes;
    const bool ends = i + 1 == runs.size() || runs[i + 1].level != runs[i].level;
    if (!ends && (bytes < next || errors.size() + 24 > ValueGrid::kMaxValueErrors)) continue;
    next = bytes + all / kSteps + 1;
    errors.push_back(
        {static_cast<std::uint32_t>(i + 1), share_of(static_cast<std::int64_t>(voxels) - right, voxels), 0});
  }
  return errors;
}

// Returns the shares of wrong labels of all steps after each level.
std::vector<ValueError> shares_of_levels(std::span<const values::StoredLabelRun> runs,
                                         std::span<const std::int64_t> sums, std::uint64_t voxels) {
  std::vector<ValueError> errors;
  std::int64_t right = 0;
  std::size_t at = 0;
  for (std::size_t level = sums.size(); level-- > 0;) {
    right += sums[level];
    while (at < runs.size() && runs[at].level == level) ++at;
    const ValueError error{static_cast<std::uint32_t>(at), share_of(static_cast<std::int64_t>(voxels) - right, voxels),
                           0};
    if (!errors.empty() && errors.back().chunks == error.chunks)
      errors.back() = error;
    else if (at > 0)
      errors.push_back(error);
  }
  return errors;
}

ValueGrid grid_of(const VolumeLayout& layout, const values::LabelPyramid& pyramid) {
  ValueGrid grid;
  grid.dimensions = layout.dimensions;
  grid.origin = layout.origin;
  grid.axes = layout.axes;
  grid.stored = pyramid.stored;
  grid.slope = grid.unit = layout.slope != 0 ? layout.slope : 1;
  grid.intercept = grid.zero = layout.intercept;
  if (layout.missing && std::isfinite(*layout.missing)) grid.missing = layout.missing;
  grid.labels = true;
  grid.palette = *pyramid.palette;
  return grid;
}

Description describe_labels(const VolumeLayout& layout, const ValueGrid& grid, const EncodeOptions& options) {
  Description about = volume_description(layout);
  std::vector<double> numbers;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  const std::uint32_t count = grid.palette.size();
  for (std::uint32_t i = 0; i < count; ++i) {
    const double number = values::number_of_code(grid.stored, grid.palette.code(i));
    if (count <= 256) numbers.push_back(number);
    least = std::min(least, number);
    most = std::max(most, number);
  }
  std::ranges::sort(numbers);
  const std::array<double, 2> ends{least * grid.slope + grid.intercept, most * grid.slope + grid.intercept};
  about.value_range = {static_cast<float>(std::min(ends[0], ends[1])), static_cast<float>(std::max(ends[0], ends[1]))};
  if (count > 256) numbers.assign(257, 0);
  about.transfer = label_transfer(numbers);
  add_metadata(options.metadata, about);
  return about;
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_labels(const VolumeSource& source, const EncodeOptions& options,
                                                       Progress* progress) {
  const std::span<const VolumeSource> steps =
      source.steps.empty() ? std::span(&source, 1) : std::span<const VolumeSource>(source.steps);
  const bool series = steps.size() > 1;
  if (steps.size() > kMaxSteps || (series && steps.size() != source.times.size()))
    return EncodeError{"the series has " + std::to_string(steps.size()) + " steps; expected at most " +
                       std::to_string(kMaxSteps)};
  MemoryStore memory;
  values::SharedStore store(options.spill ? *options.spill : memory);
  Ranks alone;
  Ranks& ranks = options.ranks ? *options.ranks : alone;
  auto read = values::read_labels(steps, store, ranks, options.threads, progress);
  if (auto* problem = std::get_if<EncodeError>(&read)) return std::move(*problem);
  const auto& pyramid = std::get<values::LabelPyramid>(read);
  PyramidEncoder encoder(pyramid, store, ranks, options.threads, progress);
  auto encoded = encoder.encode();
  if (auto* problem = std::get_if<EncodeError>(&encoded)) return std::move(*problem);
  const Runs& runs = std::get<Runs>(encoded);
  const VolumeLayout& layout = steps.front().layout;
  StreamHeader header;
  header.kind = Kind::volume;
  header.payload = Payload::values;
  header.grid = grid_of(layout, pyramid);
  header.grid.errors = series ? shares_of_levels(runs, encoder.sums(), voxel_count(layout) * steps.size())
                              : shares_of(runs, voxel_count(layout));
  header.description = describe_labels(layout, header.grid, options);
  header.cube = Cube::around(header.description.box);
  if (series) {
    header.steps.times = source.times;
    header.steps.chunks.assign(steps.size(), 0);
    for (const values::StoredLabelRun& run : runs) ++header.steps.chunks[run.step];
  }
  if (!sound(header.grid))
    return EncodeError{"the voxels are too large or too far apart; expected positions below 10^30"};
  return write_values(std::move(header), LabelChunks(layout, store, runs, series), options, "labels");
}

}  // namespace gs::qnv
