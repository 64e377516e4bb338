#include "qnv/codecs/values/encode/encode_values.h"

#include "qnv/base/morton.h"
#include "qnv/codecs/values/chunk_places.h"
#include "qnv/codecs/values/encode/error_meter.h"
#include "qnv/codecs/values/slices/slice_transform.h"
#include "qnv/container/container.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <optional>
#include <tuple>
#include <utility>

namespace gs::qnv::values {

namespace {

// Bytes of a chunk beside its payload.
constexpr std::size_t kChunkCost = kChunkHeaderBytes + kMostPlaceBytes;
// With a permitted error, clusters end at this ratio of the RMS error to it. It minimises the bytes of clusters and
// corrections together.
constexpr double kRmsOfError = 0.4;
// Number of blocks that are encoded before the rank that further clusters need is computed again.
constexpr std::uint32_t kBlocksBetween = 16;

EncodeError cannot_store(const SpillStore& store) {
  return EncodeError{"cannot keep the clusters: " + store.problem()};
}

/// Rank that a cluster needs to be among the first `max_bytes` of those seen so far. It only grows with more clusters.
class LeastRank {
 public:
  explicit LeastRank(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  [[nodiscard]] float rank() const { return rank_; }
  void add(std::span<const StoredCluster> clusters) {
    for (const StoredCluster& one : clusters)
      if (one.rank >= rank_) kept_.push_back({one.rank, one.bytes + kChunkCost});
  }
  /// Raises the rank after some clusters.
  void update() {
    std::ranges::sort(kept_, std::greater<>());
    std::size_t bytes = 0, count = 0;
    while (count < kept_.size() && bytes <= max_bytes_) bytes += kept_[count++].second;
    if (bytes <= max_bytes_) return;
    rank_ = kept_[count - 1].first;
    kept_.resize(count);
  }

 private:
  std::size_t max_bytes_;
  float rank_ = 0;
  std::vector<std::pair<float, std::size_t>> kept_;  // rank and bytes
};

/// Encodes all blocks of a volume.
class VolumeEncoder {
 public:
  /// Encodes no more than what `max_bytes` need, if that is given.
  VolumeEncoder(Extent extent, const ValuesLimit& limit, SpillStore& store, unsigned threads, Progress* progress,
                const EncodedStep* step)
      : extent_(extent),
        layout_(extent, level_count(extent)),
        store_(store),
        threads_(threads),
        progress_(progress),
        before_(step && !step->first ? &step->decoded : nullptr) {
    if (limit.max_bytes != 0) least_.emplace(limit.max_bytes);
  }

  [[nodiscard]] std::uint64_t blocks() const { return layout_.count(); }
  [[nodiscard]] const BlockLayout& layout() const { return layout_; }
  /// Encodes down to a plane; coarse levels need more.
  std::optional<EncodeError> encode(const ReadSamples& read, int last_plane) {
    clusters_.clear();
    rest_ = 0;
    problem_.reset();
    if (progress_) {
      progress_->stage = "encoding";
      progress_->done = 0;
      progress_->total = blocks();
    }
    SliceTransform transform(extent_, threads_, [&](std::uint64_t first, std::uint32_t count, LevelSlices& slices) {
      return take(first, count, slices, last_plane);
    });
    SampleBatch batch;
    const std::size_t slice = std::size_t{extent_[0]} * extent_[1];
    for (std::uint32_t z = 0; z < extent_[2]; z += kBatchSlices) {
      if (is_cancelled(progress_)) return EncodeError{"cancelled"};
      if (auto problem = read(z, std::min(kBatchSlices, extent_[2] - z), batch)) return problem;
      std::vector<SliceRows> slices;
      for (std::uint32_t i = 0; i < batch.count; ++i) slices.push_back({batch.samples.data() + i * slice, extent_[0]});
      if (!transform.add(slices)) return problem_ ? std::move(problem_) : EncodeError{"cancelled"};
    }
    return std::nullopt;
  }
  std::vector<StoredCluster>& clusters() { return clusters_; }
  /// Returns the squared error that all clusters leave.
  [[nodiscard]] double rest() const { return rest_; }

 private:
  bool take(std::uint64_t first, std::uint32_t count, LevelSlices& slices, int last_plane) {
    // With a limited size, the blocks that are encoded before tell what later ones need. The parts of a row do not
    // depend on threads.
    const std::uint32_t part = least_ ? kBlocksBetween : count;
    for (std::uint32_t i = 0; i < count; i += part)
      if (!take_part(first + i, std::min(part, count - i), slices, last_plane)) return false;
    return true;
  }

  bool take_part(std::uint64_t first, std::uint32_t count, LevelSlices& slices, int last_plane) {
    std::vector<BlockEncoder::Result> results(count);
    const float least_rank = least_ ? least_->rank() : 0;
    const bool whole = parallel_for(
        count,
        [&](std::size_t i) {
          thread_local BlockEncoder encoder;
          const BlockPlace place = layout_.place(first + i);
          // Errors of coarse bands spread: each level needs two thirds of a plane more.
          const int last = std::max(0, last_plane - 2 * (place.level - 1) / 3);
          const std::optional<BlockBands> before = before_ ? std::optional(before_->bands_of(place)) : std::nullopt;
          encoder.encode(static_cast<std::uint32_t>(first + i), place, slices.bands_of(place),
                         {last, least_rank, !least_}, before ? &*before : nullptr);
          results[i] = encoder.take();
        },
        threads_, progress_);
    if (!whole) return false;
    for (BlockEncoder::Result& result : results) {
      rest_ += result.rest;
      if (least_) least_->add(result.clusters);
      for (StoredCluster& cluster : result.clusters) {
        cluster.offset += store_.size();
        clusters_.push_back(cluster);
      }
      if (!store_.append(result.bytes)) {
        problem_ = cannot_store(store_);
        return false;
      }
    }
    if (least_) least_->update();
    return true;
  }

  Extent extent_;
  BlockLayout layout_;
  SpillStore& store_;
  unsigned threads_;
  Progress* progress_;
  StepCoefficients* before_;  // of a time series, or null
  std::vector<StoredCluster> clusters_;
  double rest_ = 0;
  std::optional<LeastRank> least_;  // null without a limited size
  std::optional<EncodeError> problem_;
};

// Sorts many clusters by steps of rank, each step in the order of space: coarse levels first, then by Morton code. So a
// view finds what it needs in few ranges of the stream.
void order_in_space(std::vector<StoredCluster>& clusters, const BlockLayout& layout) {
  constexpr float kSteps = 2;  // per octave
  struct Key {
    float step = 0;
    std::uint64_t level = 0, morton = 0;
    StoredCluster cluster;
  };
  std::vector<Key> keys;
  keys.reserve(clusters.size());
  for (const StoredCluster& cluster : clusters) {
    const BlockPlace place = layout.place(cluster.block);
    Extent at{};
    for (std::size_t a = 0; a < 3; ++a) at[a] = (place.first[a] >> place.level) / kBlockEdge & 0x1fffff;
    keys.push_back({-std::floor(kSteps * std::log2(cluster.rank)), layout.first_of(place.level),
                    morton_encode(at[0], at[1], at[2]), cluster});
  }
  std::ranges::sort(keys, [](const Key& a, const Key& b) {
    return std::tuple(a.step, a.level, a.morton, a.cluster.block, a.cluster.index) <
           std::tuple(b.step, b.level, b.morton, b.cluster.block, b.cluster.index);
  });
  std::ranges::transform(keys, clusters.begin(), &Key::cluster);
}

// Sorts clusters by rank, and drops those beyond the maximum size, if there is one. The first cluster stays.
void order_clusters(std::vector<StoredCluster>& clusters, const ValuesLimit& limit, const BlockLayout& layout) {
  constexpr std::size_t kMany = std::size_t{1} << 15;
  const std::size_t max_bytes = limit.max_bytes;
  if (clusters.size() >= kMany && max_bytes == 0 && limit.alone) return order_in_space(clusters, layout);
  std::ranges::sort(clusters, [](const StoredCluster& a, const StoredCluster& b) {
    return std::tuple(-a.rank, a.block, a.index) < std::tuple(-b.rank, b.block, b.index);
  });
  if (max_bytes == 0) return;
  std::size_t bytes = 0, count = 0;
  while (count < clusters.size() && (bytes += clusters[count].bytes + kChunkCost, bytes <= max_bytes || count == 0))
    ++count;
  clusters.resize(count);
}

/// Returns the number of clusters that reduces the RMS error to `rms`, estimated from their gains. Returns nullopt if
/// all clusters leave a larger error.
std::optional<std::size_t> clusters_for(std::span<const StoredCluster> order, double rms, std::size_t samples,
                                        double uncoded) {
  double rest = uncoded;
  for (const StoredCluster& cluster : order) rest += static_cast<double>(cluster.gain);
  const double permitted = rms * rms * static_cast<double>(samples);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (rest <= permitted) return i;
    rest -= static_cast<double>(order[i].gain);
  }
  return rest <= permitted ? std::optional(order.size()) : std::nullopt;
}

}  // namespace

std::vector<std::size_t> measured_prefixes(std::span<const StoredCluster> order, std::uint64_t samples) {
  constexpr std::size_t kFirst = 4000;
  const std::size_t factor = samples <= std::size_t{1} << 24 ? 4 : samples <= std::size_t{1} << 27 ? 16 : 64;
  std::vector<std::size_t> prefixes;
  std::size_t bytes = 0, all = 0, mark = kFirst;
  for (const StoredCluster& cluster : order) all += cluster.bytes + kChunkCost;
  for (std::size_t i = 0; i < order.size(); ++i) {
    bytes += order[i].bytes + kChunkCost;
    if (bytes < mark || 8 * bytes > all || prefixes.size() + 3 > ValueGrid::kMaxValueErrors) continue;
    prefixes.push_back(i + 1);
    while (mark <= bytes) mark *= factor;
  }
  return prefixes;
}

void store_run(const CubeRun& run, SpillStore& store, std::vector<StoredRun>& runs,
               std::optional<EncodeError>& problem) {
  if (problem) return;
  const std::vector<std::byte> packed = pack(run);
  runs.push_back({store.size(), run.first, run.count, static_cast<std::uint32_t>(packed.size())});
  if (!store.append(packed)) problem = cannot_store(store);
}

std::variant<EncodedValues, EncodeError> encode_values(const ReadSamples& read, Extent extent, const ValuesLimit& limit,
                                                       SpillStore& store, unsigned threads, Progress* progress,
                                                       const EncodedStep* step) {
  VolumeEncoder volume(extent, limit, store, threads, progress, step);
  // A permitted error of one step saves nothing.
  const bool bounded = limit.most_error > 1 && limit.max_bytes == 0;
  const bool exact = !bounded && limit.max_bytes == 0;
  EncodedValues encoded;
  for (int last_plane = bounded ? std::max(0, static_cast<int>(std::bit_width(limit.most_error)) - 2) : 0;;
       --last_plane) {
    if (auto problem = volume.encode(read, last_plane)) return std::move(*problem);
    order_clusters(volume.clusters(), limit, volume.layout());
    if (bounded) {
      const auto end =
          clusters_for(volume.clusters(), kRmsOfError * limit.most_error, sample_count(extent), volume.rest());
      if (!end && last_plane > 0) continue;
      volume.clusters().resize(end.value_or(volume.clusters().size()));
    }
    break;
  }
  encoded.clusters = std::move(volume.clusters());
  StoredBlocks blocks(store, encoded.clusters, volume.blocks());
  ErrorMeter meter(read, extent, threads, progress);
  SliceRestorer::WriteBlock write = [&](std::uint64_t number, const BlockPlace& place, const BlockBands& bands) {
    blocks.write(number, place, bands);
  };
  std::vector<std::size_t> prefixes;
  if (step) {
    blocks.keep(encoded.clusters.size());
    step->decoded.decode(blocks, step->first, threads);
    write = step->decoded.writer();
  } else {
    prefixes = measured_prefixes(encoded.clusters, sample_count(extent));
  }
  if (!exact) prefixes.push_back(encoded.clusters.size());
  std::optional<EncodeError> problem;
  for (const std::size_t clusters : prefixes) {
    const bool last = bounded && clusters == encoded.clusters.size();
    RemainderEncoder runs(extent, [&](CubeRun&& run) { store_run(run, store, encoded.corrections, problem); });
    if (!step) blocks.keep(clusters);
    auto measured = meter.measure(write, last ? limit.most_error : 0, last ? &runs : nullptr);
    if (auto* failed = std::get_if<EncodeError>(&measured)) return std::move(*failed);
    encoded.errors.push_back(std::get<ValueError>(measured));
    encoded.errors.back().chunks = static_cast<std::uint32_t>(clusters);
    if (problem) return std::move(*problem);
  }
  if (blocks.failed()) return EncodeError{"cannot read the clusters again: " + store.problem()};
  if (exact) encoded.errors.push_back({static_cast<std::uint32_t>(encoded.clusters.size()), 0, 0});
  return encoded;
}

}  // namespace gs::qnv::values
