#include "qnv/codecs/values/decode/values_slices.h"

#include "base/parallel.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/decode/sample_limits.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/labels/decode/label_volume.h"
#include "qnv/codecs/values/slices/slice_transform.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/sampling/volume/color_voxels.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

using values::Extent;

constexpr std::int32_t kMissingNumber = std::numeric_limits<std::int32_t>::min();
constexpr std::uint32_t kSlicesAtOnce = 8;  // slices that are decoded at once; a multiple of kCubeEdge

/// Place of a cluster's payload in the stream.
struct ClusterPlace {
  std::uint64_t offset = 0;
  std::uint32_t block = 0, index = 0, bytes = 0;
};
/// Place of the payload of a run of cubes.
struct RunPlace {
  std::uint64_t offset = 0, first = 0;
  std::uint32_t bytes = 0;
};

/// Chunks of a stream, found in one pass.
struct ChunkIndex {
  std::vector<ClusterPlace> clusters;      // by block and index
  std::vector<RunPlace> gaps, remainders;  // by the first cube
  std::uint32_t received = 0;              // number of different chunks
  bool in_order = true;                    // none was lost or refused
};

/// Runs of one kind, decoded layer by layer.
template <class Number>
class RunLayers {
 public:
  RunLayers(const StreamBytes& bytes, const std::vector<RunPlace>& places, Extent extent)
      : bytes_(bytes), places_(places), extent_(extent) {}

  /// Decodes the next layer into numbers that are 0.
  bool next(std::span<Number> voxels) {
    const Extent cubes = values::cube_extent(extent_);
    const std::uint64_t end = (layer_ + 1) * cubes[0] * cubes[1];
    for (; at_ < places_.size() && places_[at_].first < end; ++at_) {
      std::vector<std::byte> payload(places_[at_].bytes);
      if (!bytes_.read(places_[at_].offset, payload)) return false;
      if (auto run = values::parse_run(payload)) {
        run->first = places_[at_].first;  // the payload counts the cubes of all components
        open_.emplace_back(std::move(*run), extent_);
      }
    }
    for (auto& run : open_) (void)run.decode(layer_, voxels);
    std::erase_if(open_, [](const auto& run) { return run.done(); });
    ++layer_;
    return true;
  }

 private:
  const StreamBytes& bytes_;
  const std::vector<RunPlace>& places_;
  Extent extent_;
  std::size_t at_ = 0;  // next run to open
  std::uint64_t layer_ = 0;
  std::vector<values::RunDecoder<Number>> open_;
};

/// Decoder of the slices of a stream, in order.
class SliceReader {
 public:
  SliceReader(StreamBytes bytes, ValueGrid grid, ChunkIndex index)
      : bytes_(std::move(bytes)), grid_(std::move(grid)), index_(std::move(index)), codes_(grid_) {
    const values::BlockLayout layout(grid_.dimensions, values::level_count(grid_.dimensions));
    first_.resize(layout.count() + 1);
    std::size_t at = 0;
    for (std::size_t block = 0; block < first_.size(); ++block) {
      first_[block] = at;
      while (at < index_.clusters.size() && index_.clusters[at].block == block) ++at;
    }
  }

  [[nodiscard]] const ChunkIndex& index() const { return index_; }
  void apply(bool exact, bool corrected, const values::SampleLimits& limits) {
    exact_ = exact;
    corrected_ = corrected;
    limits_ = limits;
  }

  /// Reads slice z as 4-byte numbers: integers, or floats of an exact volume of floats.
  bool read(std::uint32_t z, std::span<std::byte> to) {
    const std::size_t slice = slice_size();
    if (z >= grid_.dimensions[2] || to.size() != slice * sizeof(std::int32_t)) return false;
    if (z < first_in_batch_ || !restorer_) restart();
    while (z >= first_in_batch_ + batch_)
      if (!decode_batch()) return false;
    std::memcpy(to.data(), decoded_.data() + (z - first_in_batch_) * slice, to.size());
    return true;
  }

 private:
  [[nodiscard]] std::size_t slice_size() const { return std::size_t{grid_.dimensions[0]} * grid_.dimensions[1]; }

  void restart() {
    restorer_.emplace(grid_.dimensions, 0,
                      [this](std::uint64_t number, const values::BlockPlace& place, const values::BlockBands& bands) {
                        write_block(number, place, bands);
                      });
    gaps_.emplace(bytes_, index_.gaps, grid_.dimensions);
    remainders_.emplace(bytes_, index_.remainders, grid_.dimensions);
    first_in_batch_ = batch_ = 0;
    failed_ = false;
  }

  void write_block(std::uint64_t number, const values::BlockPlace& place, const values::BlockBands& bands) {
    if (first_[number] == first_[number + 1]) return;
    thread_local values::BlockScratch scratch;
    thread_local std::vector<std::byte> payload;
    values::Block block(place);
    std::vector<values::Cluster> clusters;
    for (std::size_t i = first_[number]; i < first_[number + 1]; ++i) {
      payload.resize(index_.clusters[i].bytes);
      if (!bytes_.read(index_.clusters[i].offset, payload)) {
        failed_ = true;
        return;
      }
      auto cluster = values::parse_cluster(payload);
      if (!cluster) break;
      clusters.push_back(std::move(*cluster));
    }
    decode(clusters, block, scratch);
    block.write(bands);
  }

  bool decode_batch() {
    first_in_batch_ += batch_;
    batch_ = std::min(kSlicesAtOnce, grid_.dimensions[2] - first_in_batch_);
    const std::size_t slice = slice_size();
    decoded_.resize(slice * batch_);
    std::vector<values::SliceRows> rows;
    for (std::uint32_t i = 0; i < batch_; ++i) rows.push_back({decoded_.data() + i * slice, grid_.dimensions[0]});
    restorer_->next(rows);
    if (failed_) return false;
    missing_.assign(index_.gaps.empty() ? 0 : decoded_.size(), 0);
    if (!next_layers(*gaps_, missing_)) return false;
    const bool remains = (exact_ || corrected_) && !index_.remainders.empty();
    steps_.assign(remains ? decoded_.size() : 0, 0);
    if (!next_layers(*remainders_, steps_)) return false;
    (void)parallel_for(
        batch_, [&](std::size_t i) { finish_slice(i * slice, slice); }, values::threads_for(decoded_.size(), 0));
    return true;
  }

  template <class Number>
  bool next_layers(RunLayers<Number>& runs, std::vector<Number>& numbers) {
    const std::size_t layer = slice_size() * values::kCubeEdge;
    for (std::size_t at = 0; at < numbers.size(); at += layer)
      if (!runs.next(std::span(numbers).subspan(at, std::min(layer, numbers.size() - at)))) return false;
    return true;
  }

  // Applies remainders and gaps to a slice.
  void finish_slice(std::size_t first, std::size_t count) {
    const bool floats = exact_ && !values::is_integer(grid_.stored);
    if (!exact_ && !corrected_) limits_.apply(std::span(decoded_).subspan(first, count));
    for (std::size_t i = first; i < first + count; ++i) {
      auto number = static_cast<std::uint32_t>(decoded_[i]);
      const std::uint32_t step = steps_.empty() ? 0 : steps_[i];
      if (exact_)
        number = codes_(decoded_[i]) + step;
      else if (corrected_)
        number += step * grid_.correction;
      const bool missing = !missing_.empty() && missing_[i] != 0;
      if (floats)
        decoded_[i] = std::bit_cast<std::int32_t>(missing ? std::numeric_limits<float>::quiet_NaN()
                                                          : values::number_of_code(number));
      else
        decoded_[i] = missing ? kMissingNumber : static_cast<std::int32_t>(number);
    }
  }

  StreamBytes bytes_;
  const ValueGrid grid_;
  ChunkIndex index_;
  values::StoredCodes codes_;
  std::vector<std::size_t> first_;  // of the clusters of each block
  bool exact_ = false, corrected_ = false;
  values::SampleLimits limits_;
  std::optional<values::SliceRestorer> restorer_;
  std::optional<RunLayers<std::uint8_t>> gaps_;
  std::optional<RunLayers<std::uint32_t>> remainders_;
  std::uint32_t first_in_batch_ = 0, batch_ = 0;
  std::vector<std::int32_t> decoded_;
  std::vector<std::uint8_t> missing_;
  std::vector<std::uint32_t> steps_;
  std::atomic<bool> failed_{false};
};

// Keeps the clusters that can be decoded: in each block, those before the first lost one, without repetitions.
void keep_decodable(std::vector<ClusterPlace>& clusters) {
  std::ranges::sort(clusters, [](const ClusterPlace& a, const ClusterPlace& b) {
    return std::tuple(a.block, a.index, a.offset) < std::tuple(b.block, b.index, b.offset);
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const bool follows = kept > 0 && clusters[kept - 1].block == clusters[i].block;
    if (clusters[i].index == (follows ? clusters[kept - 1].index + 1 : 0)) clusters[kept++] = clusters[i];
  }
  clusters.resize(kept);
}

/// Finds the chunks of a stream.
class Indexer {
 public:
  explicit Indexer(const ValueGrid& grid)
      : gaps_(grid.gaps),
        remains_(grid.exact || grid.correction != 0),
        layout_(grid.dimensions, values::level_count(grid.dimensions)) {
    const Extent cubes = values::cube_extent(grid.dimensions);
    cubes_ = std::uint64_t{cubes[0]} * cubes[1] * cubes[2];
  }

  [[nodiscard]] values::ComponentCounts counts() const { return {layout_.count(), cubes_}; }
  /// Adds a chunk. `payload` has the number in its component; in the stream, it has `bytes` bytes at `offset`.
  void add(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset, std::size_t bytes) {
    bool good = true;
    const auto size = static_cast<std::uint32_t>(bytes);
    if (type == ChunkType::values)
      good = add_cluster(payload, offset, size);
    else if (type == ChunkType::gaps)
      good = gaps_ && add_run(payload, {offset, 0, size}, index_.gaps, gap_cubes_);
    else if (type == ChunkType::remainders)
      good = remains_ && add_run(payload, {offset, 0, size}, index_.remainders, remainder_cubes_);
    index_.in_order = index_.in_order && good;
  }
  void note_loss() { index_.in_order = false; }
  [[nodiscard]] ChunkIndex finish() {
    const std::size_t runs = index_.gaps.size() + index_.remainders.size();
    keep_decodable(index_.clusters);
    index_.received = static_cast<std::uint32_t>(runs + index_.clusters.size());
    for (auto* const of : {&index_.gaps, &index_.remainders})
      std::ranges::stable_sort(*of, {}, [](const RunPlace& run) { return run.first; });
    return std::move(index_);
  }

 private:
  bool add_cluster(std::span<const std::byte> payload, std::uint64_t offset, std::uint32_t bytes) {
    const auto cluster = values::parse_cluster(payload);
    if (!cluster || cluster->block >= layout_.count() || layout_.place(cluster->block).band_count == 0) return false;
    index_.clusters.push_back({offset, cluster->block, cluster->index, bytes});
    return true;
  }
  // Valid runs do not overlap; the limit of their cubes bounds the work for invalid streams.
  bool add_run(std::span<const std::byte> payload, RunPlace place, std::vector<RunPlace>& runs,
               std::uint64_t& cubes) const {
    const auto run = values::parse_run(payload);
    if (!run || run->first >= cubes_ || run->count > cubes_ - run->first) return false;
    cubes += run->count;
    if (cubes > 2 * cubes_) return false;
    place.first = run->first;
    runs.push_back(place);
    return true;
  }

  bool gaps_, remains_;  // the stream has such chunks
  values::BlockLayout layout_;
  std::uint64_t cubes_ = 0, gap_cubes_ = 0, remainder_cubes_ = 0;
  ChunkIndex index_;
};

/// Labels of a stream, in memory.
class LabelReceiver {
 public:
  void add(const StreamHeader& header, ChunkType type, std::span<const std::byte> payload) {
    if (!values::valid(header.grid.dimensions) || type != ChunkType::labels) return;
    if (!levels_) levels_.emplace(header.grid.dimensions, header.grid.palette.size(), 0);
    const auto run = values::parse_label_run(payload);
    const auto added = run ? levels_->add(*run) : values::AddedLabels::refused;
    if (added == values::AddedLabels::taken) ++taken_;
    good_ = good_ && added != values::AddedLabels::refused;
  }
  [[nodiscard]] std::shared_ptr<const VolumeValues> values(const StreamHeader& header, bool whole) {
    if (!levels_) levels_.emplace(header.grid.dimensions, header.grid.palette.size(), 0);
    return values::label_values(header.grid, header.description, *levels_, 0,
                                whole && good_ ? std::optional(taken_) : std::nullopt);
  }

 private:
  std::optional<values::LabelLevels> levels_;
  std::uint32_t taken_ = 0;
  bool good_ = true;
};

/// Finds the chunks of all components of a stream.
class ComponentIndexer {
 public:
  void add(const StreamHeader& header, ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    if (all_.empty()) {
      all_.emplace_back(header.grid);
      for (const ValueGrid& grid : header.more_grids) all_.emplace_back(grid);
    }
    if (type != ChunkType::values && type != ChunkType::gaps && type != ChunkType::remainders) return;
    if (all_.size() == 1) return all_.front().add(type, payload, offset, payload.size());
    const values::ComponentCounts counts = all_.front().counts();
    const auto split = values::without_component(payload, type == ChunkType::values ? counts.blocks : counts.cubes);
    if (split && split->component < all_.size())
      all_[split->component].add(type, split->payload, offset, payload.size());
    else
      for (Indexer& one : all_) one.note_loss();
  }
  /// Returns the index of a component.
  [[nodiscard]] ChunkIndex finish(std::size_t component) {
    return component < all_.size() ? all_[component].finish() : ChunkIndex();
  }

 private:
  std::vector<Indexer> all_;
};

// Sets what the received chunks say about errors.
void note_errors(const ValueGrid& grid, const ChunkIndex& index, VolumeValues& values) {
  for (const ValueError& error : grid.errors)
    if (index.in_order && error.chunks <= index.received) {
      values.error = error.most;
      values.rms = error.rms;
      values.exact = &error == &grid.errors.back() && error.most == 0;
    }
}

VolumeLayout slices_layout(const StreamHeader& header, const ValueGrid& grid, bool exact) {
  VolumeLayout layout;
  layout.dimensions = grid.dimensions;
  layout.axes = grid.axes;
  layout.origin = grid.origin;
  layout.base = header.description.origin;
  layout.metadata = header.description.metadata;
  layout.slope = exact ? grid.slope : grid.unit;
  layout.intercept = exact ? grid.intercept : grid.zero;
  layout.type = VoxelType::i32;
  layout.big_endian = std::endian::native == std::endian::big;
  if (exact && !values::is_integer(grid.stored)) layout.type = VoxelType::f32;
  if (exact && grid.stored == VoxelType::u32) layout.type = VoxelType::u32;
  if (grid.gaps && layout.type != VoxelType::f32)
    layout.missing = layout.type == VoxelType::u32 ? 2147483648.0 : static_cast<double>(kMissingNumber);
  return layout;
}

// Returns the values of a component, which are decoded when they are read.
std::shared_ptr<const VolumeValues> slices_of(const StreamHeader& head, const ValueGrid& grid, const StreamBytes& bytes,
                                              ChunkIndex index, bool limited) {
  auto made = std::make_shared<VolumeValues>();
  made->range = head.description.value_range;
  made->stored = grid.stored;
  made->slope = grid.slope;
  made->intercept = grid.intercept;
  made->missing = grid.missing;
  note_errors(grid, index, *made);
  const bool whole = !grid.errors.empty() && index.in_order && index.received >= grid.errors.back().chunks;
  const bool exact = made->exact && grid.exact;
  made->source.layout = slices_layout(head, grid, exact);
  const auto slices = std::make_shared<SliceReader>(bytes, grid, std::move(index));
  slices->apply(exact, whole && grid.correction != 0,
                limited ? values::sample_limits(made->range, grid.unit, grid.zero) : values::SampleLimits());
  made->source.read = [slices](std::uint32_t z, std::span<std::byte> to) { return slices->read(z, to); };
  return made;
}

}  // namespace

std::variant<std::shared_ptr<const VolumeValues>, StreamProblem> open_values_slices(StreamBytes bytes,
                                                                                    StreamHeader* header) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  StreamReader reader;
  ComponentIndexer indexer;
  LabelReceiver labels;
  const auto take = [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    if (reader.header()->grid.labels)
      labels.add(*reader.header(), type, payload);
    else if (reader.header()->payload == Payload::values && values::valid(reader.header()->grid.dimensions))
      indexer.add(*reader.header(), type, payload, offset + kChunkHeaderBytes);
  };
  std::vector<std::byte> piece;
  for (std::uint64_t at = 0; at < bytes.size; at += piece.size()) {
    piece.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kPiece, bytes.size - at)));
    if (!bytes.read(at, piece)) return StreamProblem{at, "cannot be read"};
    if (!reader.push(piece, take)) break;
    if (reader.header() && reader.header()->payload != Payload::values) break;
  }
  reader.finish(take);
  if (!reader.header()) return reader.problems().empty() ? StreamProblem{0, "is empty"} : reader.problems().front();
  const StreamHeader& head = *reader.header();
  if (head.payload != Payload::values) return StreamProblem{11, "has no values of voxels"};
  if (!values::valid(head.grid.dimensions))
    return StreamProblem{0, "has too many voxels; expected at most " + std::to_string(values::kMostSamples)};
  if (head.grid.labels) {
    if (header) *header = head;
    return labels.values(head, reader.problems().empty());
  }
  const bool undamaged = reader.problems().empty();
  std::vector<std::shared_ptr<const VolumeValues>> all;
  for (std::size_t c = 0; c < head.grid.components; ++c) {
    ChunkIndex index = indexer.finish(c);
    index.in_order = index.in_order && undamaged;
    // Colour differences are not in the range of the colours.
    const bool limited = !head.grid.luma || c == 0 || c == 3;
    all.push_back(slices_of(head, c == 0 ? head.grid : head.more_grids[c - 1], bytes, std::move(index), limited));
  }
  if (header) *header = head;
  if (head.grid.colors) return color_values(all, head.grid.luma);
  if (all.size() == 1) return std::move(all.front());
  auto made = std::make_shared<VolumeValues>(*all.front());
  made->components = std::move(all);
  return std::shared_ptr<const VolumeValues>(std::move(made));
}

}  // namespace gs::qnv
