#include "qnv/codecs/values/decode/chunk_index.h"

#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/cube_runs.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace gs::qnv::values {

namespace {

// Keeps the clusters that can be decoded: in each block, those before the first lost one, without repetitions.
void keep_decodable(std::vector<FoundCluster>& clusters) {
  std::ranges::sort(clusters, [](const FoundCluster& a, const FoundCluster& b) {
    return std::tuple(a.block, a.index, a.offset) < std::tuple(b.block, b.index, b.offset);
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const bool follows = kept > 0 && clusters[kept - 1].block == clusters[i].block;
    if (clusters[i].index == (follows ? clusters[kept - 1].index + 1 : 0)) clusters[kept++] = clusters[i];
  }
  clusters.resize(kept);
}

}  // namespace

ChunkIndexer::ChunkIndexer(const ValueGrid& grid, bool later)
    : later_(later),
      gaps_(grid.gaps),
      remains_(grid.exact || grid.correction != 0),
      layout_(grid.dimensions, level_count(grid.dimensions)) {
  const Extent cubes = cube_extent(grid.dimensions);
  cubes_ = std::uint64_t{cubes[0]} * cubes[1] * cubes[2];
}

void ChunkIndexer::add(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset, std::size_t bytes) {
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

ChunkIndex ChunkIndexer::finish() {
  const std::size_t runs = index_.gaps.size() + index_.remainders.size();
  keep_decodable(index_.clusters);
  index_.received = static_cast<std::uint32_t>(runs + index_.clusters.size());
  for (auto* const of : {&index_.gaps, &index_.remainders})
    std::ranges::stable_sort(*of, {}, [](const FoundRun& run) { return run.first; });
  return std::move(index_);
}

bool ChunkIndexer::add_cluster(std::span<const std::byte> payload, std::uint64_t offset, std::uint32_t bytes) {
  const auto cluster = parse_cluster(payload, later_);
  if (!cluster || cluster->block >= layout_.count() || layout_.place(cluster->block).band_count == 0) return false;
  index_.clusters.push_back({offset, cluster->block, cluster->index, bytes});
  return true;
}

// Valid runs do not overlap; the limit of their cubes bounds the work for invalid streams.
bool ChunkIndexer::add_run(std::span<const std::byte> payload, FoundRun place, std::vector<FoundRun>& runs,
                           std::uint64_t& cubes) const {
  const auto run = parse_run(payload);
  if (!run || run->first >= cubes_ || run->count > cubes_ - run->first) return false;
  cubes += run->count;
  if (cubes > 2 * cubes_) return false;
  place.first = run->first;
  runs.push_back(place);
  return true;
}

void ComponentIndexer::add(const StreamHeader& header, ChunkType type, std::span<const std::byte> payload,
                           std::uint64_t offset) {
  for (std::size_t step = 0; all_.empty() || all_.size() < header.steps.chunks.size(); ++step) {
    const bool later = step % kChainSteps != 0;
    all_.emplace_back(header.grid, later);
    for (const ValueGrid& grid : header.more_grids) all_.emplace_back(grid, later);
  }
  if (type != ChunkType::values && type != ChunkType::gaps && type != ChunkType::remainders) return;
  if (all_.size() == 1) return all_.front().add(type, payload, offset, payload.size());
  const ComponentCounts counts = all_.front().counts();
  const auto split = without_component(payload, type == ChunkType::values ? counts.blocks : counts.cubes);
  if (split && split->component < all_.size())
    all_[split->component].add(type, split->payload, offset, payload.size());
  else
    for (ChunkIndexer& one : all_) one.note_loss();
}

}  // namespace gs::qnv::values
