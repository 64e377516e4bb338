#include "qnv/codecs/values/encode/component_encoder.h"

#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/encode/encode_values.h"
#include "qnv/codecs/values/encode/error_meter.h"
#include "qnv/codecs/values/encode/sampled_volume.h"
#include "qnv/codecs/values/encode/write_values.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <tuple>

namespace gs::qnv::values {
namespace {

/// Source and target of runs.
struct RunWork {
  SampleReader& reader;
  const VolumeLayout& layout;
  SpillStore& store;
  Ranks& ranks;
  Progress* progress;
};

/// Reads the slabs of this rank batch by batch. Calls take(batch) for each batch. Returns an error if the source fails,
/// or if cancelled.
template <class Take>
std::optional<EncodeError> each_batch(const RunWork& work, bool codes, Take&& take) {
  SampleBatch batch;
  Progress* const progress = work.progress;
  const SliceWindow window = slices_of(slabs_of(work.ranks, work.layout.dimensions[2]), work.layout.dimensions[2]);
  if (progress) {
    progress->stage = "sampling";
    progress->done = 0;
    progress->total = window.end - window.first;
  }
  for (std::uint32_t z = window.first; z < window.end; z += kBatchSlices) {
    if (is_cancelled(progress)) return EncodeError{"cancelled"};
    if (auto problem = work.reader.read(z, std::min(kBatchSlices, window.end - z), codes, batch)) return problem;
    take(batch);
    if (progress) progress->done += batch.count;
  }
  return std::nullopt;
}

// Adds the layers of a batch to an encoder of runs.
template <class Number>
void add_layers(std::span<const Number> numbers, const VolumeLayout& layout, RunEncoder<Number>& encoder) {
  const std::size_t layer = slice_voxels(layout) * kCubeEdge;
  for (std::size_t at = 0; at < numbers.size(); at += layer)
    encoder.add(numbers.subspan(at, std::min(layer, numbers.size() - at)));
}

// Stores the gaps of a volume, and prepares the reader to fill them.
std::optional<EncodeError> encode_gaps(const RunWork& work, std::vector<StoredRun>& runs) {
  std::optional<EncodeError> problem;
  GapEncoder encoder(
      work.layout.dimensions, [&](CubeRun&& run) { store_run(run, work.store, runs, problem); },
      slabs_of(work.ranks, work.layout.dimensions[2]).first);
  auto failed = each_batch(work, false, [&](const SampleBatch& batch) {
    work.reader.measure_gaps(batch);
    add_layers(std::span(batch.missing), work.layout, encoder);
  });
  encoder.finish();
  if ((failed = share_runs(work.ranks, work.store, failed ? failed : problem, runs))) return failed;
  work.reader.prepare_gaps(work.ranks);
  return std::nullopt;
}

// Stores the differences between the stored voxels and the samples.
std::optional<EncodeError> encode_codes(const RunWork& work, const ValueGrid& grid, std::vector<StoredRun>& runs) {
  std::optional<EncodeError> problem;
  RemainderEncoder encoder(
      work.layout.dimensions, [&](CubeRun&& run) { store_run(run, work.store, runs, problem); },
      slabs_of(work.ranks, work.layout.dimensions[2]).first);
  const StoredCodes codes(grid);
  const auto failed = each_batch(work, true, [&](SampleBatch& batch) {
    for (std::size_t i = 0; i < batch.codes.size(); ++i)
      batch.codes[i] = !batch.missing.empty() && batch.missing[i] != 0 ? 0 : batch.codes[i] - codes(batch.samples[i]);
    add_layers(std::span<const std::uint32_t>(batch.codes), work.layout, encoder);
  });
  encoder.finish();
  return share_runs(work.ranks, work.store, failed ? failed : problem, runs);
}

// Returns the size that is left for the clusters of one component, beside their parity.
std::size_t room_for_clusters(const StreamHeader& header, std::span<const StoredRun> gaps, std::size_t max_bytes,
                              const Protection& protection) {
  std::size_t used = encode_header(header).size() + 12 * ValueGrid::kMaxValueErrors;
  for (const StoredRun& run : gaps) used += run.bytes + kChunkHeaderBytes + kMostPlaceBytes;
  const std::size_t room = max_bytes > used ? max_bytes - used : 1;
  if (room == 1 || protection.kind == Protection::Kind::none) return room;
  // The first groups are small and have more parity than the others.
  const bool equal = protection.kind == Protection::Kind::equal;
  const double all = static_cast<double>(room),
               of_first = equal ? std::min(4000.0, all / 2) : std::min(1500.0, all / 4);
  return std::max<std::size_t>(1, static_cast<std::size_t>((all - of_first) / (1 + parity_share(protection))));
}

ValueError in_values(ValueError error, float rounding, const ValueGrid& grid) {
  const auto unit = static_cast<float>(std::abs(grid.unit));
  error.most = error.most * unit + rounding;
  error.rms = std::hypot(error.rms * unit, rounding / std::sqrt(3.0f));
  return error;
}

// Reports whether a step of a time series may refer to the one before.
bool starts_chain(std::size_t step) { return step % kChainSteps == 0; }

/// Encoder of one component, step by step.
class ComponentEncoder {
 public:
  ComponentEncoder(std::span<const VolumeSource> steps, std::size_t component, const EncodeOptions& options,
                   SpillStore& store, Progress* progress)
      : steps_(steps),
        component_(component),
        options_(options),
        ranks_(options.ranks ? *options.ranks : alone_),
        store_(store),
        progress_(progress) {}

  std::variant<EncodedComponent, EncodeError> encode(StreamHeader header, bool alone);

 private:
  [[nodiscard]] bool is_series() const { return steps_.size() > 1; }
  std::optional<EncodeError> encode_step(std::size_t step, const StreamHeader& header, bool alone);
  /// Orders the clusters of all steps by their gain in all steps that depend on them. If `max_bytes` is not 0, drops
  /// the clusters beyond it.
  void order_steps(std::size_t max_bytes);
  std::optional<EncodeError> measure_prefixes();
  void finish_errors();

  std::span<const VolumeSource> steps_;
  std::size_t component_;
  const EncodeOptions& options_;
  Ranks alone_;
  Ranks& ranks_;
  SpillStore& store_;
  Progress* progress_;
  SampledVolume volume_;
  std::optional<StepCoefficients> decoded_;  // of a time series
  EncodedComponent made_;
  std::vector<ValueError> last_;                                 // errors of each step at its end
  std::vector<std::pair<StoredCluster, std::uint32_t>> merged_;  // clusters of all steps with their step, in order
};

std::optional<EncodeError> ComponentEncoder::encode_step(std::size_t step, const StreamHeader& header, bool alone) {
  const VolumeLayout& layout = steps_[step].layout;
  ValueGrid& grid = made_.grid;
  ComponentParts& parts = made_.steps[step];
  SampleReader reader(steps_[step], volume_, options_.threads);
  const RunWork runs{reader, layout, store_, ranks_, progress_};
  if (grid.gaps)
    if (auto problem = encode_gaps(runs, parts.gaps)) return problem;
  ValuesLimit limit{volume_.most_error, 0, alone && !is_series()};
  if (options_.max_bytes != 0)
    limit.max_bytes = room_for_clusters(header, parts.gaps, options_.max_bytes, values_protection(options_));
  std::optional<EncodedStep> encoded_step;
  if (decoded_) encoded_step.emplace(EncodedStep{*decoded_, starts_chain(step)});
  auto encoding = values::encode_values(
      [&](std::uint32_t first, std::uint32_t count, SampleBatch& batch) {
        return reader.read(first, count, false, batch);
      },
      layout.dimensions, limit, store_, options_.threads, progress_, encoded_step ? &*encoded_step : nullptr,
      {options_.ranks, "c" + std::to_string(component_) + "s" + std::to_string(step)});
  if (auto* problem = std::get_if<EncodeError>(&encoding)) return std::move(*problem);
  auto& encoded = std::get<EncodedValues>(encoding);
  parts.clusters = std::move(encoded.clusters);
  last_.push_back(encoded.errors.back());
  if (!is_series())
    for (ValueError error : encoded.errors) {
      error.chunks += static_cast<std::uint32_t>(parts.gaps.size());
      grid.errors.push_back(in_values(error, volume_.rounding, grid));
    }
  if (grid.exact) return encode_codes(runs, grid, parts.remainders);
  parts.remainders = std::move(encoded.corrections);
  if (!parts.remainders.empty()) grid.correction = correction_step(volume_.most_error);
  return std::nullopt;
}

void ComponentEncoder::order_steps(std::size_t max_bytes) {
  const BlockLayout layout(made_.grid.dimensions, level_count(made_.grid.dimensions));
  // Number of steps that a block of the current step changes.
  std::vector<std::uint8_t> uses(layout.count(), 1);
  for (std::size_t step = steps_.size(); step-- > 0;) {
    std::vector<std::uint8_t> own(uses.size(), 1);
    if (step + 1 < steps_.size() && !starts_chain(step + 1)) {
      // The step after this one refers to blocks that it does not replace.
      std::vector<bool> replaced(uses.size());
      for (const StoredCluster& cluster : made_.steps[step + 1].clusters)
        if (cluster.index == 0 && cluster.differs == 0) replaced[cluster.block] = true;
      for (std::size_t block = 0; block < own.size(); ++block)
        if (!replaced[block]) own[block] = static_cast<std::uint8_t>(1 + uses[block]);
    }
    uses = std::move(own);
    for (StoredCluster& cluster : made_.steps[step].clusters) {
      cluster.rank *= static_cast<float>(uses[cluster.block]);
      cluster.gain *= static_cast<float>(uses[cluster.block]);
    }
    std::ranges::sort(made_.steps[step].clusters, [](const StoredCluster& a, const StoredCluster& b) {
      return std::tuple(-a.rank, a.block, a.index) < std::tuple(-b.rank, b.block, b.index);
    });
  }
  // In streams that are worth reading in part, clusters of about equal rank are in the order of the steps, so that one
  // step is few ranges.
  constexpr std::size_t kWorthGrouping = 1024;
  constexpr float kGroups = 2;  // per octave
  std::size_t all = 0;
  for (const ComponentParts& parts : made_.steps) all += parts.clusters.size();
  if (all >= kWorthGrouping && options_.max_bytes == 0)
    for (ComponentParts& parts : made_.steps)
      for (StoredCluster& cluster : parts.clusters)
        if (cluster.rank > 0) cluster.rank = std::exp2(std::floor(kGroups * std::log2(cluster.rank)) / kGroups);
  for (std::size_t step = 0; step < steps_.size(); ++step)
    for (const StoredCluster& cluster : made_.steps[step].clusters)
      merged_.emplace_back(cluster, static_cast<std::uint32_t>(step));
  std::ranges::stable_sort(merged_, std::greater{}, [](const auto& one) { return one.first.rank; });
  if (max_bytes == 0) return;
  std::size_t bytes = 0, kept = 0;
  while (kept < merged_.size() && (bytes += merged_[kept].first.bytes + kChunkHeaderBytes + kDirectoryEntryBytes,
                                   bytes <= max_bytes || kept == 0))
    ++kept;
  merged_.resize(kept);
  std::vector<std::size_t> counts(steps_.size(), 0);
  for (const auto& [cluster, step] : merged_) ++counts[step];
  for (std::size_t step = 0; step < steps_.size(); ++step) made_.steps[step].clusters.resize(counts[step]);
}

std::optional<EncodeError> ComponentEncoder::measure_prefixes() {
  const ValueGrid& grid = made_.grid;
  std::vector<StoredCluster> order;
  for (const auto& [cluster, step] : merged_) order.push_back(cluster);
  std::vector<std::size_t> prefixes = measured_prefixes(order, sample_count(grid.dimensions) * steps_.size());
  const bool cut = options_.max_bytes != 0;  // the end of the stream is a prefix, too
  if (cut) prefixes.push_back(order.size());
  std::size_t before = 0;
  for (const ComponentParts& parts : made_.steps) before += parts.gaps.size();
  const BlockLayout layout(grid.dimensions, level_count(grid.dimensions));
  for (const std::size_t prefix : prefixes) {
    std::vector<std::size_t> counts(steps_.size(), 0);
    for (std::size_t i = 0; i < prefix; ++i) ++counts[merged_[i].second];
    ValueError error{static_cast<std::uint32_t>(before + prefix), 0, 0};
    double squares = 0;
    for (std::size_t step = 0; step < steps_.size(); ++step) {
      StoredBlocks blocks(store_, made_.steps[step].clusters, layout.count());
      blocks.keep(counts[step]);
      decoded_->decode(blocks, starts_chain(step), options_.threads);
      SampleReader reader(steps_[step], volume_, options_.threads);
      const ReadSamples read = [&](std::uint32_t first, std::uint32_t count, SampleBatch& batch) {
        return reader.read(first, count, false, batch);
      };
      std::optional<EncodeError> failed;
      if (blocks.failed()) failed = EncodeError{"cannot read the clusters again: " + store_.problem()};
      if ((failed = agree(ranks_, failed))) return failed;
      auto measured = ErrorMeter(read, grid.dimensions, options_.threads, ranks_, progress_)
                          .measure(decoded_->writer(), 0, nullptr);
      if (auto* problem = std::get_if<EncodeError>(&measured)) return std::move(*problem);
      const auto& one = std::get<ValueError>(measured);
      error.most = std::max(error.most, one.most);
      squares += std::pow(static_cast<double>(one.rms), 2);
      if (cut && prefix == order.size()) last_[step] = one;
    }
    error.rms = static_cast<float>(std::sqrt(squares / static_cast<double>(steps_.size())));
    if (!cut || prefix < order.size()) made_.grid.errors.push_back(in_values(error, volume_.rounding, grid));
  }
  return std::nullopt;
}

// Sets the error at the end.
void ComponentEncoder::finish_errors() {
  ValueGrid& grid = made_.grid;
  std::size_t end = 0;
  bool remain = false;
  for (const ComponentParts& parts : made_.steps) {
    end += parts.gaps.size() + parts.clusters.size() + parts.remainders.size();
    remain = remain || !parts.remainders.empty();
  }
  const auto chunks = static_cast<std::uint32_t>(end);
  if (is_series()) {
    ValueError error{chunks, 0, 0};
    double squares = 0;
    for (const ValueError& one : last_) {
      error.most = std::max(error.most, one.most);
      squares += std::pow(static_cast<double>(one.rms), 2);
    }
    error.rms = static_cast<float>(std::sqrt(squares / static_cast<double>(last_.size())));
    error = grid.exact ? ValueError{chunks, 0, 0} : in_values(error, volume_.rounding, grid);
    while (!grid.errors.empty() && grid.errors.back().chunks >= chunks) grid.errors.pop_back();
    grid.errors.push_back(error);
    return;
  }
  if (grid.exact) grid.errors.back().most = volume_.rounding;
  if (!remain && !grid.exact) return;
  if (!grid.exact)
    grid.errors.back().chunks = chunks;
  else if (grid.errors.back().chunks < chunks)
    grid.errors.push_back({chunks, 0, 0});
  else
    grid.errors.back() = {chunks, 0, 0};  // all remainders are 0
}

std::variant<EncodedComponent, EncodeError> ComponentEncoder::encode(StreamHeader header, bool alone) {
  auto sampled = sample_volume(steps_, options_.tolerance, ranks_, progress_);
  if (auto* problem = std::get_if<EncodeError>(&sampled)) return std::move(*problem);
  volume_ = std::move(std::get<SampledVolume>(sampled));
  made_.range = volume_.value_range;
  made_.grid = volume_.grid;
  made_.steps.resize(steps_.size());
  if (!sound(made_.grid))
    return EncodeError{"the voxels are too many, too large or too far apart; expected at most 2^31 voxels"};
  header.grid = volume_.grid;
  header.description = volume_description(steps_.front().layout);
  header.description.transfer = default_transfer(made_.range.first, made_.range.second);
  for (const auto& pair : options_.metadata) header.description.metadata.push_back(pair);
  if (is_series()) decoded_.emplace(made_.grid.dimensions);
  for (std::size_t step = 0; step < steps_.size(); ++step)
    if (auto problem = encode_step(step, header, alone)) {
      if (is_series()) problem->message = "step " + std::to_string(step) + ": " + problem->message;
      return std::move(*problem);
    }
  if (is_series()) {
    std::vector<StoredRun> gaps;
    for (const ComponentParts& parts : made_.steps) gaps.insert(gaps.end(), parts.gaps.begin(), parts.gaps.end());
    const bool cuts = options_.max_bytes != 0 && alone;
    order_steps(cuts ? room_for_clusters(header, gaps, options_.max_bytes, values_protection(options_)) : 0);
    if (auto problem = measure_prefixes()) return std::move(*problem);
  }
  finish_errors();
  for (ComponentParts& parts : made_.steps) parts.weight = made_.grid.unit * made_.grid.unit;
  return std::move(made_);
}

}  // namespace

std::variant<EncodedComponent, EncodeError> encode_component(std::span<const VolumeSource> steps, std::size_t component,
                                                             StreamHeader header, bool alone,
                                                             const EncodeOptions& options, SpillStore& store,
                                                             Progress* progress) {
  return ComponentEncoder(steps, component, options, store, progress).encode(std::move(header), alone);
}

}  // namespace gs::qnv::values
