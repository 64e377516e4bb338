#include "qnv/codecs/values/labels/encode/label_stream.h"

#include "qnv/codecs/values/encode/write_values.h"
#include "qnv/codecs/values/labels/encode/label_pyramid.h"
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
#include <string>
#include <utility>

namespace gs::qnv {
namespace {

using values::Extent;

/// Encoded run with its use.
struct PackedLabels {
  std::vector<std::byte> payload;
  Extent first{}, last{};      // box in the voxels of the volume, `last` is excluded
  std::int64_t corrected = 0;  // voxels that get their label; less those that lose it
  std::uint8_t level = 0;
};

/// Encodes the runs of all levels.
class PyramidEncoder {
 public:
  PyramidEncoder(const values::LabelPyramid& pyramid, unsigned threads, Progress* progress)
      : pyramid_(pyramid), threads_(threads), progress_(progress) {}

  /// Returns the runs in the order of the stream, or nothing if cancelled.
  std::vector<PackedLabels> encode() {
    const std::size_t levels = pyramid_.levels.size();
    std::vector<std::vector<PackedLabels>> all(levels);
    if (progress_) {
      progress_->stage = "encoding";
      progress_->done = 0;
      progress_->total = levels;
    }
    const bool whole = parallel_for(
        levels,
        [&](std::size_t level) {
          all[level] = encode_level(level);
          if (progress_) ++progress_->done;
        },
        threads_, progress_);
    std::vector<PackedLabels> runs;
    if (!whole) return runs;
    for (std::size_t level = levels; level-- > 0;)
      for (PackedLabels& run : all[level]) runs.push_back(std::move(run));
    return runs;
  }

 private:
  std::vector<PackedLabels> encode_level(std::size_t level) const {
    const values::LabelGrid& grid = pyramid_.levels[level];
    const values::CubeOrder order(grid.extent);
    std::vector<PackedLabels> runs;
    std::vector<std::uint32_t> run_of(std::size_t{order.cubes()[0]} * order.cubes()[1] * order.cubes()[2]);
    values::encode_label_runs(
        grid, order, pyramid_.palette.size(), static_cast<int>(level), [&](values::LabelRun&& run) {
          PackedLabels packed;
          packed.level = run.level;
          packed.first = grid.extent;
          for (std::uint64_t code = run.first; code < run.first + run.count; ++code) {
            const Extent cube = order.place(code);
            if (!order.has(cube)) continue;
            run_of[(std::size_t{cube[2]} * order.cubes()[1] + cube[1]) * order.cubes()[0] + cube[0]] =
                static_cast<std::uint32_t>(runs.size());
            for (std::size_t a = 0; a < 3; ++a) {
              packed.first[a] = std::min(packed.first[a], cube[a] * values::kCubeEdge);
              packed.last[a] = std::max(packed.last[a], cube[a] * values::kCubeEdge + values::kCubeEdge);
            }
          }
          for (std::size_t a = 0; a < 3; ++a) {
            packed.first[a] <<= level;
            packed.last[a] = static_cast<std::uint32_t>(
                std::min<std::uint64_t>(std::uint64_t{packed.last[a]} << level, pyramid_.levels[0].extent[a]));
          }
          packed.payload = values::pack(run);
          runs.push_back(std::move(packed));
        });
    count_corrected(level, order.cubes(), run_of, runs);
    std::ranges::stable_sort(runs, std::greater{}, [](const PackedLabels& run) {
      return static_cast<double>(run.corrected) / static_cast<double>(run.payload.size() + kChunkHeaderBytes);
    });
    return runs;
  }

  // Counts for each run the voxels that get their right label, less those that are right with the coarser level.
  void count_corrected(std::size_t level, const Extent& cubes, std::span<const std::uint32_t> run_of,
                       std::vector<PackedLabels>& runs) const {
    const values::LabelGrid &truth = pyramid_.levels[0], &here = pyramid_.levels[level];
    const values::LabelGrid* const before = level + 1 < pyramid_.levels.size() ? &pyramid_.levels[level + 1] : nullptr;
    const auto row_of = [](const values::LabelGrid& grid, std::uint32_t y, std::uint32_t z) {
      return grid.labels.data() + (std::size_t{z} * grid.extent[1] + y) * grid.extent[0];
    };
    const std::size_t shift = level + 2;  // from voxels to cubes
    static_assert(values::kCubeEdge == 1u << 2);
    const std::uint32_t* label = truth.labels.data();
    for (std::uint32_t z = 0; z < truth.extent[2]; ++z)
      for (std::uint32_t y = 0; y < truth.extent[1]; ++y) {
        const std::uint32_t* const fine = row_of(here, y >> level, z >> level);
        const std::uint32_t* const coarse = before ? row_of(*before, y >> (level + 1), z >> (level + 1)) : nullptr;
        const std::uint32_t* const run = run_of.data() + (std::size_t{z >> shift} * cubes[1] + (y >> shift)) * cubes[0];
        for (std::uint32_t x = 0; x < truth.extent[0]; ++x, ++label) {
          const bool was = coarse && coarse[x >> (level + 1)] == *label, is = fine[x >> level] == *label;
          if (was != is) runs[run[x >> shift]].corrected += is ? 1 : -1;
        }
      }
  }

  const values::LabelPyramid& pyramid_;
  unsigned threads_;
  Progress* progress_;
};

/// Chunks of a stream of labels.
class LabelChunks final : public ChunkList {
 public:
  LabelChunks(const VolumeLayout& layout, std::span<const PackedLabels> runs) : layout_(layout), runs_(runs) {}
  [[nodiscard]] std::size_t size() const override { return runs_.size(); }
  [[nodiscard]] std::optional<OutgoingChunk> chunk(std::size_t i) const override {
    const PackedLabels& run = runs_[i];
    OutgoingChunk chunk;
    chunk.type = ChunkType::labels;
    chunk.payload = run.payload;
    chunk.gain = static_cast<double>(std::max<std::int64_t>(run.corrected, 0));
    chunk.entry.parent = 0xffffffff;
    chunk.entry.level = run.level;
    double voxels = 1;
    for (std::size_t a = 0; a < 3; ++a) voxels *= run.last[a] - run.first[a];
    if (run.level == 0) chunk.entry.vectors = static_cast<std::uint32_t>(std::min(voxels * kShownFraction, 1e9));
    for (unsigned corner = 0; corner < 8; ++corner) {
      const auto end = [&](std::size_t a) {
        return (corner >> a & 1) != 0 ? run.last[a] - 1.0 : static_cast<double>(run.first[a]);
      };
      chunk.entry.box.add(voxel_position(layout_, end(0), end(1), end(2)));
    }
    return chunk;
  }

 private:
  const VolumeLayout& layout_;
  std::span<const PackedLabels> runs_;
};

// Returns the shares of wrong labels after some sizes, and after each level.
std::vector<ValueError> shares_of(std::span<const PackedLabels> runs, std::uint64_t voxels) {
  constexpr std::size_t kSteps = 40;
  std::vector<ValueError> errors;
  std::int64_t right = 0;
  std::size_t bytes = 0, all = 0, next = 0;
  for (const PackedLabels& run : runs) all += run.payload.size();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    right += runs[i].corrected;
    bytes += runs[i].payload.size();
    const bool ends = i + 1 == runs.size() || runs[i + 1].level != runs[i].level;
    if (!ends && (bytes < next || errors.size() + 24 > ValueGrid::kMaxValueErrors)) continue;
    next = bytes + all / kSteps + 1;
    const auto wrong = static_cast<double>(static_cast<std::int64_t>(voxels) - right) / static_cast<double>(voxels);
    // Rounded up, so that only exact labels have no error.
    auto share = static_cast<float>(wrong);
    if (static_cast<double>(share) < wrong) share = std::nextafter(share, 2.0f);
    errors.push_back({static_cast<std::uint32_t>(i + 1), share, 0});
  }
  return errors;
}

ValueGrid grid_of(const VolumeLayout& layout, values::LabelPyramid& pyramid) {
  ValueGrid grid;
  grid.dimensions = layout.dimensions;
  grid.origin = layout.origin;
  grid.axes = layout.axes;
  grid.stored = pyramid.stored;
  grid.slope = grid.unit = layout.slope != 0 ? layout.slope : 1;
  grid.intercept = grid.zero = layout.intercept;
  if (layout.missing && std::isfinite(*layout.missing)) grid.missing = layout.missing;
  grid.labels = true;
  grid.palette = std::move(pyramid.palette);
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
  auto read = values::read_labels(source, options.threads, progress);
  if (auto* problem = std::get_if<EncodeError>(&read)) return std::move(*problem);
  auto& pyramid = std::get<values::LabelPyramid>(read);
  const std::vector<PackedLabels> runs = PyramidEncoder(pyramid, options.threads, progress).encode();
  if (runs.empty()) return EncodeError{"cancelled"};
  const VolumeLayout& layout = source.layout;
  StreamHeader header;
  header.kind = Kind::volume;
  header.payload = Payload::values;
  header.grid = grid_of(layout, pyramid);
  header.grid.errors = shares_of(runs, voxel_count(layout));
  header.description = describe_labels(layout, header.grid, options);
  header.cube = Cube::around(header.description.box);
  if (!sound(header.grid))
    return EncodeError{"the voxels are too large or too far apart; expected positions below 10^30"};
  return write_values(std::move(header), LabelChunks(layout, runs), options, "labels");
}

}  // namespace gs::qnv
