#include "qnv/codecs/values/decode/values_slices.h"

#include "base/parallel.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/decode/chunk_index.h"
#include "qnv/codecs/values/decode/sample_limits.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/labels/decode/label_slices.h"
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
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

using values::BlockClusters;
using values::ChunkIndex;
using values::ComponentIndexer;
using values::Extent;
using values::FoundCluster;
using values::FoundRun;

constexpr std::int32_t kMissingNumber = std::numeric_limits<std::int32_t>::min();
constexpr std::uint32_t kSlicesAtOnce = 8;  // slices that are decoded at once; a multiple of kCubeEdge

/// Steps of a time series up to the decoded one, or a single volume.
using ClusterChain = std::vector<std::shared_ptr<const BlockClusters>>;

/// Runs of one kind, decoded layer by layer.
template <class Number>
class RunLayers {
 public:
  RunLayers(const StreamBytes& bytes, const std::vector<FoundRun>& places, Extent extent)
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
  const std::vector<FoundRun>& places_;
  Extent extent_;
  std::size_t at_ = 0;  // next run to open
  std::uint64_t layer_ = 0;
  std::vector<values::RunDecoder<Number>> open_;
};

/// Decoder of the slices of a stream, in order.
class SliceReader {
 public:
  SliceReader(StreamBytes bytes, ValueGrid grid, ClusterChain chain, ChunkIndex index)
      : bytes_(std::move(bytes)),
        grid_(std::move(grid)),
        chain_(std::move(chain)),
        index_(std::move(index)),
        codes_(grid_) {}

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

  // Adds a block of the last step, and of those to which it is a difference.
  void write_block(std::uint64_t number, const values::BlockPlace& place, const values::BlockBands& bands) {
    thread_local std::vector<std::byte> payload;
    std::size_t begin = chain_.size();
    for (bool differs = true; differs && begin > 0;) {
      const auto clusters = chain_[--begin]->of(number);
      if (clusters.empty()) continue;
      const auto first = begin > 0 ? read_cluster(clusters.front(), payload) : std::nullopt;
      differs = first && first->differs;
    }
    for (; begin < chain_.size(); ++begin) add_block(chain_[begin]->of(number), place, bands, payload);
  }

  std::optional<values::Cluster> read_cluster(const FoundCluster& place, std::vector<std::byte>& payload) {
    payload.resize(place.bytes);
    if (!bytes_.read(place.offset, payload)) {
      failed_ = true;
      return std::nullopt;
    }
    return values::parse_cluster(payload, chain_.size() > 1);
  }

  void add_block(std::span<const FoundCluster> places, const values::BlockPlace& place, const values::BlockBands& bands,
                 std::vector<std::byte>& payload) {
    if (places.empty()) return;
    thread_local values::BlockScratch scratch;
    values::Block block(place);
    std::vector<values::Cluster> clusters;
    for (const FoundCluster& one : places) {
      auto cluster = read_cluster(one, payload);
      if (!cluster) break;
      clusters.push_back(std::move(*cluster));
    }
    if (failed_) return;
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
  ClusterChain chain_;
  ChunkIndex index_;  // without its clusters
  values::StoredCodes codes_;
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

/// Collector of the labels of a stream.
class LabelReceiver {
 public:
  void add(const StreamHeader& header, ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    if (!values::valid(header.grid.dimensions) || type != ChunkType::labels) return;
    prepare(header);
    auto run = values::parse_label_run(payload);
    std::uint64_t step = 0;
    const auto& orders = steps_.front()->layout().orders;
    if (run && run->level < orders.size()) step = values::take_step(*run, orders[run->level].codes());
    const bool refers = run && run->differs && step % kChainSteps == 0;
    good_ = run && !refers && step < steps_.size() &&
            steps_[static_cast<std::size_t>(step)]->add(*run, payload.size(), offset) && good_;
  }
  [[nodiscard]] std::shared_ptr<const VolumeValues> values(const StreamHeader& header, const StreamBytes& bytes,
                                                           bool whole) {
    prepare(header);
    std::uint32_t taken = 0;
    for (const auto& step : steps_) {
      step->finish();
      taken += step->count();
    }
    const auto in_order = whole && good_ ? std::optional(taken) : std::nullopt;
    if (header.steps.times.empty())
      return values::label_slices(header.grid, header.description, {steps_.front()}, bytes.read,
                                  steps_.front()->is_whole(0), in_order);
    std::vector<std::shared_ptr<const VolumeValues>> all;
    values::LabelChain chain;
    bool complete = true;
    for (std::size_t step = 0; step < steps_.size(); ++step) {
      if (step % kChainSteps == 0) {
        chain.clear();
        complete = true;
      }
      chain.push_back(steps_[step]);
      complete = complete && steps_[step]->count() >= header.steps.chunks[step];
      auto made = values::label_slices(header.grid, header.description, chain, bytes.read, complete, in_order);
      made->step = static_cast<std::uint32_t>(step);
      made->times = header.steps.times;
      all.push_back(std::move(made));
    }
    auto made = std::make_shared<VolumeValues>(*all.front());
    made->steps = std::move(all);
    return made;
  }

 private:
  void prepare(const StreamHeader& header) {
    if (!steps_.empty()) return;
    const auto layout = std::make_shared<const values::LabelLayout>(header.grid.dimensions);
    for (std::size_t step = 0; step < std::max<std::size_t>(1, header.steps.times.size()); ++step)
      steps_.push_back(std::make_shared<values::LabelRunIndex>(layout));
  }
  std::vector<std::shared_ptr<values::LabelRunIndex>> steps_;  // one for a single volume
  bool good_ = true;
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

/// Parameters of the slices of a component.
struct SlicesOf {
  const StreamHeader& head;
  const ValueGrid& grid;
  const StreamBytes& bytes;
  bool limited = true;  // to the range of the header
};

// Returns the values of a component, which are decoded when they are read.
std::shared_ptr<const VolumeValues> slices_of(const SlicesOf& of, ClusterChain chain, ChunkIndex index) {
  const ValueGrid& grid = of.grid;
  auto made = std::make_shared<VolumeValues>();
  made->range = of.head.description.value_range;
  made->stored = grid.stored;
  made->slope = grid.slope;
  made->intercept = grid.intercept;
  made->missing = grid.missing;
  made->times = of.head.steps.times;
  note_errors(grid, index, *made);
  const bool whole = !grid.errors.empty() && index.in_order && index.received >= grid.errors.back().chunks;
  const bool exact = made->exact && grid.exact;
  made->source.layout = slices_layout(of.head, grid, exact);
  const auto slices = std::make_shared<SliceReader>(of.bytes, grid, std::move(chain), std::move(index));
  slices->apply(exact, whole && grid.correction != 0,
                of.limited ? values::sample_limits(made->range, grid.unit, grid.zero) : values::SampleLimits());
  made->source.read = [slices](std::uint32_t z, std::span<std::byte> to) { return slices->read(z, to); };
  return made;
}

/// Values of all components, step by step.
class StepSlices {
 public:
  StepSlices(const StreamHeader& head, const StreamBytes& bytes, ComponentIndexer& indexer, bool undamaged)
      : head_(head),
        bytes_(bytes),
        indexer_(indexer),
        undamaged_(undamaged),
        chains_(head.grid.components),
        whole_(head.grid.components, true) {}

  /// Returns the values of the next step.
  std::shared_ptr<const VolumeValues> next() {
    std::vector<std::shared_ptr<const VolumeValues>> all;
    for (std::size_t c = 0; c < head_.grid.components; ++c) all.push_back(component(c));
    const std::uint32_t step = step_++;
    if (all.size() == 1) return numbered(*all.front(), step);
    if (head_.grid.colors) return numbered(*color_values(all, head_.grid.luma), step);
    auto made = std::make_shared<VolumeValues>(*all.front());
    made->components = std::move(all);
    return numbered(*made, step);
  }

 private:
  static std::shared_ptr<const VolumeValues> numbered(const VolumeValues& values, std::uint32_t step) {
    auto made = std::make_shared<VolumeValues>(values);
    made->step = step;
    return made;
  }

  std::shared_ptr<const VolumeValues> component(std::size_t c) {
    ValueGrid grid = c == 0 ? head_.grid : head_.more_grids[c - 1];
    const std::size_t number = step_ * head_.grid.components + c;
    ChunkIndex index = indexer_.finish(number);
    index.in_order = index.in_order && undamaged_;
    ClusterChain& chain = chains_[c];
    if (step_ % kChainSteps == 0) {
      chain.clear();
      whole_[c] = true;
    }
    if (!head_.steps.chunks.empty()) {
      // The error at the end holds for a step if all chunks of its chain are there.
      whole_[c] = whole_[c] && index.in_order && index.received >= head_.steps.chunks[number];
      index.in_order = whole_[c];
      if (!grid.errors.empty()) {
        grid.errors = {grid.errors.back()};
        grid.errors.back().chunks = head_.steps.chunks[number];
      }
    }
    const values::BlockLayout layout(grid.dimensions, values::level_count(grid.dimensions));
    chain.push_back(std::make_shared<const BlockClusters>(std::move(index.clusters), layout.count()));
    index.clusters.clear();
    // Colour differences are not in the range of the colours.
    const bool limited = !head_.grid.luma || c == 0 || c == 3;
    return slices_of({head_, grid, bytes_, limited}, chain, std::move(index));
  }

  const StreamHeader& head_;
  const StreamBytes& bytes_;
  ComponentIndexer& indexer_;
  const bool undamaged_;
  std::uint32_t step_ = 0;
  std::vector<ClusterChain> chains_;  // by component
  std::vector<bool> whole_;           // by component: nothing of the chain is missing
};

}  // namespace

std::variant<std::shared_ptr<const VolumeValues>, StreamProblem> open_values_slices(StreamBytes bytes,
                                                                                    StreamHeader* header) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  StreamReader reader;
  ComponentIndexer indexer;
  LabelReceiver labels;
  const auto take = [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    if (reader.header()->grid.labels)
      labels.add(*reader.header(), type, payload, offset + kChunkHeaderBytes);
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
    return labels.values(head, bytes, reader.problems().empty());
  }
  if (header) *header = head;
  StepSlices steps(head, bytes, indexer, reader.problems().empty());
  if (head.steps.times.empty()) return steps.next();
  std::vector<std::shared_ptr<const VolumeValues>> all;
  while (all.size() < head.steps.times.size()) all.push_back(steps.next());
  auto made = std::make_shared<VolumeValues>(*all.front());
  made->steps = std::move(all);
  return std::shared_ptr<const VolumeValues>(std::move(made));
}

}  // namespace gs::qnv
