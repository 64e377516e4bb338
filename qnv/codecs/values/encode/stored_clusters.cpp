#include "qnv/codecs/values/encode/stored_clusters.h"

#include "qnv/codecs/values/cluster.h"
#include "qnv/container/container.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gs::qnv::values {

namespace {

// A plane that ends after at least this many bytes ends its cluster, too.
constexpr std::size_t kPlaneClusterBytes = 500;
constexpr std::size_t kLengthBytes = 2;
// Bytes of a chunk beside its payload.
constexpr std::size_t kClusterCost = kChunkHeaderBytes + kDirectoryEntryBytes;
// A block ends at a cluster if the least useful one so far gains this many times more per byte. Later clusters of a
// block are seldom better.
constexpr float kSparedGain = 4;

}  // namespace

void BlockEncoder::encode(std::uint32_t number, const BlockPlace& place, const BlockBands& bands, int last_plane,
                          float least_rank) {
  result_ = {};
  Block block(place);
  const int top = block.load(bands);
  result_.rest = block.energy();
  if (top < 0) return;
  block.start(top);
  std::vector<StoredCluster>& clusters = result_.clusters;
  while (block.plane() >= last_plane) {
    const Block::Encoded coded = block.encode(kPlaneClusterBytes, kClusterEnd, last_plane, scratch_);
    const std::vector<std::byte> packed =
        pack({number, static_cast<std::uint32_t>(clusters.size()), coded.steps, static_cast<std::uint8_t>(top),
              std::vector<std::byte>(coded.bytes.begin(), coded.bytes.end())});
    result_.rest -= coded.gain;
    StoredCluster next;
    next.block = number;
    next.index = static_cast<std::uint16_t>(clusters.size());
    next.bytes = static_cast<std::uint16_t>(packed.size());
    next.gain = static_cast<float>(coded.gain);
    for (std::size_t i = 0; i < kLengthBytes; ++i)
      result_.bytes.push_back(static_cast<std::byte>(packed.size() >> (8 * i) & 255));
    next.offset = result_.bytes.size();
    result_.bytes.insert(result_.bytes.end(), packed.begin(), packed.end());
    clusters.push_back(next);
    if (next.gain * kSparedGain < least_rank * static_cast<float>(next.bytes + kClusterCost)) break;
  }
  // The rank of a cluster is the highest gain per byte of any sequence that begins with it. No cluster ranks before
  // those that it needs.
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    double gain = 0, slope = 0;
    std::size_t bytes = 0;
    for (std::size_t k = i; k < clusters.size(); ++k) {
      gain += static_cast<double>(clusters[k].gain);
      bytes += clusters[k].bytes + kClusterCost;
      slope = std::max(slope, gain / static_cast<double>(bytes));
    }
    clusters[i].rank = least = std::min(least, static_cast<float>(slope));
  }
}

StoredBlocks::StoredBlocks(const SpillStore& store, std::span<const StoredCluster> order, std::uint64_t blocks)
    : store_(store), order_(order), kept_(blocks) {}

void StoredBlocks::keep(std::size_t clusters) {
  for (; count_ < clusters; ++count_) {
    const StoredCluster& one = order_[count_];
    Kept& kept = kept_[one.block];
    if (one.index == 0) kept.offset = one.offset - kLengthBytes;
    kept.bytes += one.bytes + static_cast<std::uint32_t>(kLengthBytes);
  }
}

void StoredBlocks::write(std::uint64_t number, const BlockPlace& place, const BlockBands& bands) const {
  const Kept& kept = kept_[number];
  if (kept.bytes == 0) return;
  thread_local std::vector<std::byte> bytes;
  thread_local BlockScratch scratch;
  bytes.resize(kept.bytes);
  if (!store_.read(kept.offset, bytes)) {
    failed_ = true;
    return;
  }
  Block block(place);
  std::vector<Cluster> clusters;
  std::span<const std::byte> rest = bytes;
  while (rest.size() > kLengthBytes) {
    const auto size = std::to_integer<std::size_t>(rest[0]) | std::to_integer<std::size_t>(rest[1]) << 8;
    auto cluster = parse_cluster(rest.subspan(kLengthBytes, size));
    if (!cluster) break;
    clusters.push_back(std::move(*cluster));
    rest = rest.subspan(kLengthBytes + size);
  }
  decode(clusters, block, scratch);
  block.write(bands);
}

}  // namespace gs::qnv::values
