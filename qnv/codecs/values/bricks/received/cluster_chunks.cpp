#include "qnv/codecs/values/bricks/received/cluster_chunks.h"

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

std::span<const ClusterPlace> ClusterChunks::of(std::uint64_t block) const {
  const auto found = places_.find(block);
  if (found == places_.end()) return {};
  const std::vector<ClusterPlace>& all = found->second;
  std::size_t count = 0;
  while (count < all.size() && all[count].index == count) ++count;
  return std::span(all).first(count);
}

std::size_t ClusterChunks::known(std::uint64_t block) const {
  const auto found = places_.find(block);
  return found != places_.end() ? found->second.size() : 0;
}

std::optional<Cluster> ClusterChunks::read(const ClusterPlace& place) const {
  if (!source_) {
    const std::vector<std::byte>* const payload = kept_.find(place.offset);
    return payload ? parse_cluster(*payload) : std::nullopt;
  }
  thread_local std::vector<std::byte> buffer;
  const auto chunk = read_chunk(*source_, place.offset, place.bytes, buffer);
  const auto* const sound = std::get_if<SoundChunk>(&chunk);
  return sound && sound->type == ChunkType::values ? parse_cluster(sound->payload) : std::nullopt;
}

}  // namespace gs::qnv::values
