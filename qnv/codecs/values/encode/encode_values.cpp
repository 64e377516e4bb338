#include "qnv/codecs/values/encode/encode_values.h"

#include "qnv/base/morton.h"
#include "qnv/codecs/values/encode/error_meter.h"
#include "qnv/codecs/values/encode/volume_encoder.h"
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

// With a permitted error, clusters end at this ratio of the RMS error to it. It minimises the bytes of clusters and
// corrections together.
constexpr double kRmsOfError = 0.4;
EncodeError cannot_store(const SpillStore& store) {
  return EncodeError{"cannot keep the clusters: " + store.problem()};
}

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
  while (count < clusters.size() &&
         (bytes += clusters[count].bytes + kClusterChunkCost, bytes <= max_bytes || count == 0))
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
  for (const StoredCluster& cluster : order) all += cluster.bytes + kClusterChunkCost;
  for (std::size_t i = 0; i < order.size(); ++i) {
    bytes += order[i].bytes + kClusterChunkCost;
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

std::optional<EncodeError> share_runs(Ranks& ranks, SpillStore& store, const std::optional<EncodeError>& problem,
                                      std::vector<StoredRun>& runs) {
  std::optional<EncodeError> own = problem;
  if (!own && !store.publish()) own = cannot_store(store);
  if ((own = agree(ranks, own))) return own;
  runs = gather_records(ranks, std::span<const StoredRun>(runs));
  return std::nullopt;
}

std::variant<EncodedValues, EncodeError> encode_values(const ReadSamples& read, Extent extent, const ValuesLimit& limit,
                                                       SpillStore& store, unsigned threads, Progress* progress,
                                                       const EncodedStep* step, const SharedWork& work) {
  Ranks alone;
  Ranks& ranks = work.ranks ? *work.ranks : alone;
  VolumeEncoder volume(extent, limit, store, threads, progress, step, work);
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
  ErrorMeter meter(read, extent, threads, ranks, progress);
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
    RemainderEncoder runs(
        extent, [&](CubeRun&& run) { store_run(run, store, encoded.corrections, problem); },
        slabs_of(ranks, extent[2]).first);
    if (!step) blocks.keep(clusters);
    auto measured = meter.measure(write, last ? limit.most_error : 0, last ? &runs : nullptr);
    if (auto* failed = std::get_if<EncodeError>(&measured)) return std::move(*failed);
    encoded.errors.push_back(std::get<ValueError>(measured));
    encoded.errors.back().chunks = static_cast<std::uint32_t>(clusters);
  }
  if (blocks.failed()) problem = EncodeError{"cannot read the clusters again: " + store.problem()};
  if (auto failed = share_runs(ranks, store, problem, encoded.corrections)) return std::move(*failed);
  if (exact) encoded.errors.push_back({static_cast<std::uint32_t>(encoded.clusters.size()), 0, 0});
  return encoded;
}

}  // namespace gs::qnv::values
