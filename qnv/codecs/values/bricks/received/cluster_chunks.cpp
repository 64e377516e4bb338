#include "qnv/codecs/values/bricks/received/cluster_chunks.h"

#include "qnv/codecs/values/component_number.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace gs::qnv::values {

std::optional<Cluster> StepChain::parse(std::span<const std::byte> payload, std::uint32_t* step) const {
  if (!series) return parse_cluster(payload);
  const auto part = without_component(payload, blocks);
  if (!part || !has(part->component)) return std::nullopt;
  if (step) *step = static_cast<std::uint32_t>(part->component);
  return parse_cluster(part->payload, part->component % kChainSteps != 0);
}

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

std::optional<Cluster> ClusterChunks::read(std::uint64_t block, const ClusterPlace& place) const {
  const auto parsed = [&](std::span<const std::byte> payload) {
    std::uint32_t step = 0;
    auto cluster = chain_.parse(payload, &step);
    return cluster && chain_.number(step, cluster->block) == block ? std::move(cluster) : std::nullopt;
  };
  if (!source_) {
    const std::vector<std::byte>* const payload = kept_.find(place.offset);
    return payload ? parsed(*payload) : std::nullopt;
  }
  thread_local std::vector<std::byte> buffer;
  const auto chunk = read_chunk(*source_, place.offset, place.bytes, buffer);
  const auto* const sound = std::get_if<SoundChunk>(&chunk);
  return sound && sound->type == ChunkType::values ? parsed(sound->payload) : std::nullopt;
}

}  // namespace gs::qnv::values
