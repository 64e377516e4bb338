#include "qnv/codecs/values/encode/stored_clusters.h"

#include "qnv/codecs/values/cluster.h"
#include "qnv/container/container.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
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

namespace {

// Returns an estimate of the bits of coefficients down to a plane. nullopt if a coefficient is too large.
std::optional<std::uint64_t> bits_of(const BlockPlace& place, const BlockBands& bands, int plane) {
  constexpr std::uint32_t kFirst = 2;  // place and sign of a coefficient that is not zero
  std::uint64_t bits = 0;
  std::uint32_t all = 0;
  for (std::uint32_t b = 0; b < place.band_count; ++b)
    for (std::uint32_t z = 0; z < place.bands[b].size[2]; ++z)
      for (std::uint32_t y = 0; y < place.bands[b].size[1]; ++y) {
        const std::int32_t* const row = bands.parts[b][z] + y * bands.row;
        for (std::uint32_t x = 0; x < place.bands[b].size[0]; ++x) {
          const auto size = row[x] < 0 ? 0u - static_cast<std::uint32_t>(row[x]) : static_cast<std::uint32_t>(row[x]);
          all |= size;
          const std::uint32_t coded = size >> plane;
          bits += coded != 0 ? static_cast<std::uint32_t>(std::bit_width(coded)) + kFirst : 0;
        }
      }
  return all >> kHighestPlane >> 1 == 0 ? std::optional(bits) : std::nullopt;
}

}  // namespace

void BlockEncoder::put_cluster(const Block::Encoded& coded, std::uint32_t number, int top, bool differs) {
  std::vector<StoredCluster>& clusters = result_.clusters;
  const std::vector<std::byte> packed =
      pack({number, static_cast<std::uint32_t>(clusters.size()), coded.steps, static_cast<std::uint8_t>(top),
            std::vector<std::byte>(coded.bytes.begin(), coded.bytes.end()), differs});
  StoredCluster next;
  next.block = number;
  next.index = static_cast<std::uint16_t>(clusters.size());
  next.bytes = static_cast<std::uint16_t>(packed.size() & 0x7fff);
  next.differs = differs ? 1 : 0;
  next.gain = static_cast<float>(coded.gain);
  for (std::size_t i = 0; i < kLengthBytes; ++i)
    result_.bytes.push_back(static_cast<std::byte>(packed.size() >> (8 * i) & 255));
  next.offset = result_.bytes.size();
  result_.bytes.insert(result_.bytes.end(), packed.begin(), packed.end());
  clusters.push_back(next);
}

void BlockEncoder::encode(std::uint32_t number, const BlockPlace& place, const BlockBands& bands,
                          const CodedPlanes& planes, const BlockBands* before) {
  result_ = {};
  Block block(place);
  int top = -1;
  bool differs = false;
  double without = 0;  // squared error without clusters
  if (before) {
    difference_.subtract(place, bands, *before);
    top = block.load(difference_.bands());
    without = block.energy();
    constexpr int kCompared = 5;  // planes that decide about differences unless all are kept
    const int compared = planes.all ? planes.last : std::max(planes.last, top - kCompared);
    const auto own = bits_of(place, bands, compared), changed = bits_of(place, difference_.bands(), compared);
    differs = changed && (!own || *changed <= *own);
    // A block without clusters is that of the step before. Zeros must be stated.
    if (!differs) top = std::max(block.load(bands), planes.last);
  } else {
    top = block.load(bands);
    without = block.energy();
  }
  // Clusters of a block that is no difference replace the step before, too.
  double replaced = differs || !before ? 0 : without - block.energy();
  result_.rest = without;
  if (top < 0) return;
  block.start(top);
  std::vector<StoredCluster>& clusters = result_.clusters;
  while (block.plane() >= planes.last) {
    Block::Encoded coded = block.encode(kPlaneClusterBytes, kClusterEnd, planes.last, scratch_);
    coded.gain += std::exchange(replaced, 0);
    put_cluster(coded, number, top, differs);
    result_.rest -= coded.gain;
    if (clusters.back().gain * kSparedGain <
        planes.least_rank * static_cast<float>(clusters.back().bytes + kClusterCost))
      break;
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
    if (one.index == 0) {
      kept.offset = one.offset - kLengthBytes;
      kept.first = static_cast<std::uint32_t>(count_);
    }
    kept.bytes += one.bytes + static_cast<std::uint32_t>(kLengthBytes);
  }
}

const StoredCluster* StoredBlocks::write(std::uint64_t number, const BlockPlace& place, const BlockBands& bands) const {
  const Kept& kept = kept_[number];
  if (kept.bytes == 0) return nullptr;
  thread_local std::vector<std::byte> bytes;
  thread_local BlockScratch scratch;
  bytes.resize(kept.bytes);
  if (!store_.read(kept.offset, bytes)) {
    failed_ = true;
    return nullptr;
  }
  Block block(place);
  std::vector<Cluster> clusters;
  std::span<const std::byte> rest = bytes;
  while (rest.size() > kLengthBytes) {
    const auto size = std::to_integer<std::size_t>(rest[0]) | std::to_integer<std::size_t>(rest[1]) << 8;
    auto cluster = parse_cluster(rest.subspan(kLengthBytes, size), true);
    if (!cluster) break;
    clusters.push_back(std::move(*cluster));
    rest = rest.subspan(kLengthBytes + size);
  }
  decode(clusters, block, scratch);
  block.write(bands);
  return &order_[kept.first];
}

}  // namespace gs::qnv::values
