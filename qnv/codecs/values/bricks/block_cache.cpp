#include "qnv/codecs/values/bricks/block_cache.h"

#include "base/parallel.h"
#include "qnv/codecs/values/cluster.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace gs::qnv::values {

std::uint32_t BlockCache::received(std::uint64_t block, const ClusterChunks& chunks) {
  const std::span<const ClusterPlace> all = chunks.of(block);
  const auto lost = std::ranges::find_if(all, [&](const ClusterPlace& place) { return !chunks.has(place); });
  return static_cast<std::uint32_t>(lost - all.begin());
}

void BlockCache::decode(std::uint64_t number, State& state, const ClusterChunks& chunks) const {
  thread_local BlockScratch scratch;
  const std::span<const ClusterPlace> all = chunks.of(number);
  std::vector<Cluster> clusters;
  while (!state.damaged && state.next < all.size() && chunks.has(all[state.next])) {
    auto cluster = chunks.read(number, all[state.next]);
    if (!cluster || cluster->index != state.next || cluster->plane > kHighestPlane) {
      state.damaged = true;
      break;
    }
    if (!state.block) {
      state.block = std::make_unique<Block>(layout_.place(number % layout_.count()));
      state.block->start(cluster->plane);
      state.differs = cluster->differs;
    }
    clusters.push_back(std::move(*cluster));
    ++state.next;
  }
  if (state.block) (void)values::decode(clusters, *state.block, scratch);
  state.bytes = sizeof(State) + (state.block ? state.block->bytes() : 0);
}

void BlockCache::decode(std::span<const std::uint64_t> blocks, const ClusterChunks& chunks) {
  ++time_;
  std::vector<std::pair<std::uint64_t, State*>> work;
  for (const std::uint64_t number : blocks) {
    State& state = blocks_[number];
    if (state.used == time_) continue;
    state.used = time_;
    bytes_ -= state.bytes;
    work.emplace_back(number, &state);
  }
  (void)parallel_for(work.size(), [&](std::size_t i) { decode(work[i].first, *work[i].second, chunks); });
  for (const auto& [number, state] : work) bytes_ += state->bytes;
}

const Block* BlockCache::find(std::uint64_t block) const {
  const auto found = blocks_.find(block);
  return found != blocks_.end() ? found->second.block.get() : nullptr;
}

bool BlockCache::differs(std::uint64_t block) const {
  const auto found = blocks_.find(block);
  return found != blocks_.end() && found->second.differs;
}

bool BlockCache::whole(std::uint64_t block, const ClusterChunks& chunks) const {
  const std::size_t known = chunks.known(block);
  if (known == 0) return true;
  const auto found = blocks_.find(block);
  return found != blocks_.end() && !found->second.damaged && found->second.next == known;
}

void BlockCache::trim(std::size_t most_bytes) {
  if (bytes_ <= most_bytes) return;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> order;  // time of use, and number
  for (const auto& [number, state] : blocks_) order.emplace_back(state.used, number);
  std::ranges::sort(order);
  for (const auto& [used, number] : order) {
    if (bytes_ <= most_bytes) break;
    const auto found = blocks_.find(number);
    bytes_ -= found->second.bytes;
    blocks_.erase(found);
  }
}

}  // namespace gs::qnv::values
