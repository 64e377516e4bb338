#include "qnv/codecs/values/bricks/cluster_chunks.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace gs::qnv::values {

bool ClusterChunks::note(std::uint64_t block, const ClusterPlace& place) {
  // The planes of all coefficients of a block fit into a quarter of these.
  constexpr std::uint32_t kMostClusters = 512;
  if (place.index >= kMostClusters) return false;
  std::vector<ClusterPlace>& all = places_[block];
  const auto at = std::ranges::lower_bound(all, place.index, {}, &ClusterPlace::index);
  if (at != all.end() && at->index == place.index) return at->offset == place.offset;
  if (count_ >= kMaxDirectoryEntries) return false;
  all.insert(at, place);
  ++count_;
  return true;
}

void ClusterChunks::keep(std::uint64_t block, std::uint64_t offset, std::span<const std::byte> payload) {
  const auto [at, fresh] = kept_.try_emplace(offset);
  if (!fresh) return;
  at->second = {block, {payload.begin(), payload.end()}};
  bytes_ += payload.size();
  dropped_.erase(offset);
}

void ClusterChunks::trim(const std::function<bool(std::uint64_t block)>& used) {
  // The last chunks of the stream are the finest, so they go first.
  for (auto at = kept_.end(); bytes_ > most_bytes_ && at != kept_.begin();) {
    --at;
    if (used(at->second.block)) continue;
    bytes_ -= at->second.payload.size();
    dropped_.insert(at->first);
    at = kept_.erase(at);
  }
}

std::span<const ClusterPlace> ClusterChunks::of(std::uint64_t block) const {
  const auto found = places_.find(block);
  if (found == places_.end()) return {};
  const std::vector<ClusterPlace>& all = found->second;
  std::size_t count = 0;
  while (count < all.size() && all[count].index == count) ++count;
  return std::span(all).first(count);
}

std::optional<Cluster> ClusterChunks::read(const ClusterPlace& place) const {
  if (!source_) {
    const auto found = kept_.find(place.offset);
    return found != kept_.end() ? parse_cluster(found->second.payload) : std::nullopt;
  }
  thread_local std::vector<std::byte> buffer;
  const auto chunk = read_chunk(*source_, place.offset, place.bytes, buffer);
  const auto* const sound = std::get_if<SoundChunk>(&chunk);
  return sound && sound->type == ChunkType::values ? parse_cluster(sound->payload) : std::nullopt;
}

}  // namespace gs::qnv::values
