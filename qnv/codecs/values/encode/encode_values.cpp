#include "qnv/codecs/values/encode/encode_values.h"

#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/container/container.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <queue>
#include <utility>

namespace gs::qnv::values {

namespace {

// A plane that ends after at least this many bytes ends its cluster, too.
constexpr std::size_t kPlaneClusterBytes = 500;
// Bytes of a chunk beside its payload.
constexpr std::size_t kChunkCost = kChunkHeaderBytes + kDirectoryEntryBytes;
// Sizes at which errors are measured: this many bytes, and each time this factor more.
constexpr std::size_t kFirstMeasured = 4000, kMeasuredFactor = 4;
// With a permitted error, clusters end at this ratio of the RMS error to it. It minimises the bytes of clusters and
// corrections together.
constexpr double kRmsOfError = 0.4;

struct RankedCluster {
  Cluster cluster;
  std::size_t bytes = 0;
  double gain = 0;
  double slope = 0;  // highest gain per byte of this and following clusters together
};

// Encodes a block down to a plane. Sets `rest` to the squared error that remains.
std::vector<RankedCluster> encode_block(const BlockPlace& place, std::uint32_t number,
                                        std::span<const std::int32_t> bands, Extent extent, int last_plane,
                                        double& rest) {
  std::vector<RankedCluster> clusters;
  Block block(place);
  const int top = block.load(bands, extent);
  rest = block.energy();
  if (top < 0) return clusters;
  block.start(top);
  BlockScratch scratch;
  while (block.plane() >= last_plane) {
    RankedCluster next;
    next.cluster = {number, static_cast<std::uint32_t>(clusters.size()), 0, static_cast<std::uint8_t>(top), {}};
    BinaryEncoder encoder;
    const Block::Encoded coded = block.encode(encoder, kPlaneClusterBytes, kClusterEnd, last_plane, scratch);
    rest -= coded.gain;
    next.cluster.steps = coded.steps;
    next.gain = coded.gain;
    next.cluster.bytes = encoder.finish();
    next.bytes = pack(next.cluster).size() + kChunkCost;
    clusters.push_back(std::move(next));
  }
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    double gain = 0;
    std::size_t bytes = 0;
    for (std::size_t k = i; k < clusters.size(); ++k) {
      gain += clusters[k].gain;
      bytes += clusters[k].bytes;
      clusters[i].slope = std::max(clusters[i].slope, gain / static_cast<double>(bytes));
    }
  }
  return clusters;
}

/// Returns the clusters of all blocks in the order of their slopes, at most `max_bytes`.
std::vector<RankedCluster> ranked(std::vector<std::vector<RankedCluster>> blocks, std::size_t max_bytes) {
  using Candidate =
      std::pair<double, std::size_t>;  // slope; block count minus block number, so that ties choose the lower block
  std::priority_queue<Candidate> candidates;
  std::vector<std::size_t> next(blocks.size(), 0);
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (!blocks[i].empty()) candidates.push({blocks[i][0].slope, blocks.size() - i});
  std::vector<RankedCluster> order;
  std::size_t bytes = 0;
  while (!candidates.empty()) {
    const std::size_t i = blocks.size() - candidates.top().second;
    candidates.pop();
    RankedCluster& cluster = blocks[i][next[i]++];
    bytes += cluster.bytes;
    if (max_bytes > 0 && bytes > max_bytes && !order.empty()) break;
    order.push_back(std::move(cluster));
    if (next[i] < blocks[i].size()) candidates.push({blocks[i][next[i]].slope, blocks.size() - i});
  }
  return order;
}

/// Measures the errors of prefixes, from short ones to long ones.
class ErrorMeter {
 public:
  ErrorMeter(std::span<const std::int32_t> samples, Extent extent, std::span<const RankedCluster> order)
      : samples_(samples), order_(order), decoder_(extent) {}

  /// Decodes the first `chunks` clusters, which must not be fewer than in the calls before.
  ValueError measure(std::size_t chunks) {
    for (; added_ < chunks; ++added_) decoder_.add(order_[added_].cluster);
    decoded_ = decoder_.samples();
    return error();
  }
  /// Corrects the decoded samples. Returns the numbers of steps; empty if none are needed.
  std::vector<std::uint32_t> correct(std::uint32_t most_error) {
    std::vector<std::uint32_t> corrections(samples_.size(), 0);
    const std::int64_t step = correction_step(most_error), most = most_error;
    bool any = false;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const std::int64_t apart = std::int64_t{samples_[i]} - decoded_[i];
      if (apart >= -most && apart <= most) continue;
      any = true;
      const std::int64_t steps = (apart >= 0 ? apart + most : apart - most) / step;
      corrections[i] = static_cast<std::uint32_t>(steps);
      decoded_[i] = static_cast<std::int32_t>(decoded_[i] + steps * step);
    }
    return any ? std::move(corrections) : std::vector<std::uint32_t>();
  }
  /// Returns the error of the decoded samples.
  [[nodiscard]] ValueError error() const {
    std::int64_t most = 0;
    double sum = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const std::int64_t apart = std::abs(std::int64_t{samples_[i]} - decoded_[i]);
      most = std::max(most, apart);
      sum += static_cast<double>(apart) * static_cast<double>(apart);
    }
    return {static_cast<std::uint32_t>(added_), static_cast<float>(most),
            static_cast<float>(std::sqrt(sum / static_cast<double>(samples_.size())))};
  }

 private:
  std::span<const std::int32_t> samples_;
  std::span<const RankedCluster> order_;
  ValuesDecoder decoder_;
  std::vector<std::int32_t> decoded_;
  std::size_t added_ = 0;
};

/// Returns the number of clusters that reduces the RMS error to `rms`, estimated from their gains. Returns nullopt if
/// all clusters leave a larger error.
std::optional<std::size_t> clusters_for(std::span<const RankedCluster> order, double rms, std::size_t samples,
                                        double uncoded) {
  double rest = uncoded;
  for (const RankedCluster& cluster : order) rest += cluster.gain;
  const double permitted = rms * rms * static_cast<double>(samples);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (rest <= permitted) return i;
    rest -= order[i].gain;
  }
  return rest <= permitted ? std::optional(order.size()) : std::nullopt;
}

/// Measures errors after certain sizes and at the end, and corrects the end if `most_error` is given.
void measure(std::span<const std::int32_t> samples, Extent extent, std::span<const RankedCluster> order,
             std::optional<std::uint32_t> most_error, bool exact, EncodedValues& encoded, Progress* progress) {
  std::size_t bytes = 0, all = 0, mark = kFirstMeasured;
  for (const RankedCluster& cluster : order) all += cluster.bytes;
  ErrorMeter meter(samples, extent, order);
  for (std::size_t i = 0; i < order.size() && !is_cancelled(progress); ++i) {
    bytes += order[i].bytes;
    if (bytes < mark || 2 * bytes > all || encoded.errors.size() + 3 > ValueGrid::kMaxValueErrors) continue;
    encoded.errors.push_back(meter.measure(i + 1));
    while (mark <= bytes) mark *= kMeasuredFactor;
  }
  if (exact) return encoded.errors.push_back({static_cast<std::uint32_t>(order.size()), 0, 0});
  ValueError end = meter.measure(order.size());
  if (most_error) {
    encoded.corrections = meter.correct(*most_error);
    end = meter.error();
  }
  encoded.errors.push_back(end);
}

}  // namespace

std::optional<EncodedValues> encode_values(std::span<const std::int32_t> samples, Extent extent,
                                           const ValuesLimit& limit, unsigned threads, Progress* progress) {
  if (!valid(extent) || samples.size() != sample_count(extent)) return std::nullopt;
  std::vector<std::int32_t> bands(samples.begin(), samples.end());
  const int levels = level_count(extent);
  transform(bands, extent, levels);
  const BlockLayout layout(extent, levels);
  const auto block_count = static_cast<std::size_t>(layout.count());
  if (progress) {
    progress->stage = "encoding";
    progress->done = 0;
    progress->total = block_count;
  }
  // A permitted error of one step saves nothing.
  const bool bounded = limit.most_error > 1 && limit.max_bytes == 0;
  for (int last_plane = bounded ? std::max(0, static_cast<int>(std::bit_width(limit.most_error)) - 2) : 0;;
       --last_plane) {
    std::vector<std::vector<RankedCluster>> blocks(block_count);
    std::vector<double> rests(block_count, 0);
    const bool whole = parallel_for(
        block_count,
        [&](std::size_t i) {
          const BlockPlace place = layout.place(i);
          // Errors of coarse bands spread: each level needs two thirds of a plane more.
          const int last = std::max(0, last_plane - 2 * (place.level - 1) / 3);
          blocks[i] = encode_block(place, static_cast<std::uint32_t>(i), bands, extent, last, rests[i]);
          if (progress) ++progress->done;
        },
        threads, progress);
    if (!whole) return std::nullopt;
    std::vector<RankedCluster> order = ranked(std::move(blocks), limit.max_bytes);
    if (bounded) {
      double uncoded = 0;
      for (const double rest : rests) uncoded += rest;
      const auto end = clusters_for(order, kRmsOfError * limit.most_error, samples.size(), uncoded);
      if (!end && last_plane > 0) continue;
      order.resize(end.value_or(order.size()));
    }
    EncodedValues encoded;
    measure(samples, extent, order, bounded ? std::optional(limit.most_error) : std::nullopt,
            !bounded && limit.max_bytes == 0, encoded, progress);
    if (is_cancelled(progress)) return std::nullopt;
    for (RankedCluster& cluster : order) {
      encoded.gains.push_back(cluster.gain);
      encoded.clusters.push_back(std::move(cluster.cluster));
    }
    return encoded;
  }
}

}  // namespace gs::qnv::values
