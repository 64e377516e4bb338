#include "qnv/codecs/values/encode/values_chunks.h"

#include "qnv/base/short_number.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/gradients.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace gs::qnv::values {

namespace {

// Box of voxels from `first`, with the reach of the wavelets.
Box box_of(const VolumeLayout& layout, const Extent& first, const Extent& size, int level) {
  const double reach = std::ldexp(4.0, std::max(level - 1, 0));
  std::array<std::array<double, 2>, 3> ends{};
  for (std::size_t a = 0; a < 3; ++a)
    ends[a] = {std::max(0.0, first[a] - reach),
               std::min(layout.dimensions[a] - 1.0, static_cast<double>(first[a]) + size[a] + reach)};
  Box box;
  for (unsigned c = 0; c < 8; ++c)
    box.add(voxel_position(layout, ends[0][c & 1], ends[1][c >> 1 & 1], ends[2][c >> 2]));
  return box;
}

Box box_of_run(const VolumeLayout& layout, const StoredRun& run) {
  const Extent cubes = cube_extent(layout.dimensions);
  const std::uint64_t slice = std::uint64_t{cubes[0]} * cubes[1];
  const auto first = static_cast<std::uint32_t>(run.first / slice),
             last = static_cast<std::uint32_t>((run.first + run.count - 1) / slice);
  return box_of(layout, {0, 0, first * kCubeEdge},
                {layout.dimensions[0], layout.dimensions[1], (last - first + 1) * kCubeEdge}, 0);
}

}  // namespace

ValuesChunks::ValuesChunks(const VolumeLayout& layout, const SpillStore& store, std::span<const ComponentParts> parts)
    : layout_(layout), store_(store), parts_(parts), blocks_(layout.dimensions, level_count(layout.dimensions)) {
  for (const ComponentParts& part : parts)
    for (const StoredCluster& cluster : part.clusters)
      most_gain_ = std::max(most_gain_, static_cast<double>(cluster.gain) * part.weight);
  if (parts.size() > 1) merge();
}

void ValuesChunks::merge() {
  for (std::size_t c = 0; c < parts_.size(); ++c)
    for (const StoredRun& run : parts_[c].gaps) merged_.push_back({&run, nullptr, c, true});
  std::size_t begin = merged_.size();
  for (std::size_t c = 0; c < parts_.size(); ++c)
    for (const StoredCluster& cluster : parts_[c].clusters) merged_.push_back({nullptr, &cluster, c, false});
  // The clusters of a component are already in this order, which a stable sort keeps.
  const auto from = [&](std::size_t first) { return merged_.begin() + static_cast<std::ptrdiff_t>(first); };
  std::ranges::stable_sort(from(begin), merged_.end(), std::greater{}, [this](const Place& place) {
    return static_cast<double>(place.cluster->rank) * parts_[place.component].weight;
  });
  begin = merged_.size();
  for (std::size_t c = 0; c < parts_.size(); ++c)
    for (const StoredRun& run : parts_[c].remainders) merged_.push_back({&run, nullptr, c, false});
  std::ranges::stable_sort(from(begin), merged_.end(), {}, [](const Place& place) { return place.run->first; });
}

std::size_t ValuesChunks::size() const {
  if (!merged_.empty()) return merged_.size();
  const ComponentParts& part = parts_.front();
  return part.gaps.size() + part.clusters.size() + part.remainders.size();
}

ValuesChunks::Place ValuesChunks::place_of(std::size_t i) const {
  if (!merged_.empty()) return merged_[i];
  const ComponentParts& part = parts_.front();
  if (i < part.gaps.size()) return {&part.gaps[i], nullptr, 0, true};
  i -= part.gaps.size();
  if (i < part.clusters.size()) return {nullptr, &part.clusters[i], 0, false};
  return {&part.remainders[i - part.clusters.size()], nullptr, 0, false};
}

bool ValuesChunks::read(const Place& place, std::vector<std::byte>& payload) const {
  payload.resize(place.run ? place.run->bytes : place.cluster->bytes);
  if (!store_.read(place.run ? place.run->offset : place.cluster->offset, payload)) return false;
  if (place.component == 0) return true;
  const Extent cubes = cube_extent(layout_.dimensions);
  const ComponentCounts counts{blocks_.count(), std::uint64_t{cubes[0]} * cubes[1] * cubes[2]};
  payload = with_component(payload, place.component, place.run ? counts.cubes : counts.blocks);
  return true;
}

std::optional<OutgoingChunk> ValuesChunks::chunk(std::size_t i) const {
  OutgoingChunk chunk;
  chunk.entry.parent = 0xffffffff;
  const Place place = place_of(i);
  if (!read(place, chunk.payload)) return std::nullopt;
  if (place.run) {
    chunk.type = place.gaps ? ChunkType::gaps : ChunkType::remainders;
    // A lost chunk of gaps leaves wrong values where there are none.
    if (place.gaps) chunk.gain = most_gain_;
    chunk.entry.box = box_of_run(layout_, *place.run);
    return chunk;
  }
  const BlockPlace block = blocks_.place(place.cluster->block);
  chunk.type = ChunkType::values;
  chunk.entry.box = box_of(layout_, block.first, block.size, block.level);
  chunk.entry.level = static_cast<std::uint8_t>(block.level);
  chunk.gain = static_cast<double>(place.cluster->gain) * parts_[place.component].weight;
  chunk.chain = static_cast<std::uint32_t>(place.component * blocks_.count() + place.cluster->block);
  if (place.component == 0 && place.cluster->index == 0 && block.level == 1)
    chunk.entry.vectors = static_cast<std::uint32_t>(kShownFraction * static_cast<double>(sample_count(block.size)));
  return chunk;
}

}  // namespace gs::qnv::values
