#include "qnv/codecs/values/encode/values_chunks.h"

#include "qnv/base/short_number.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/cube_runs.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace gs::qnv::values {

ValuesChunks::ValuesChunks(const ValueGrid& grid, const SpillStore& store, std::span<const ComponentParts> parts)
    : store_(store),
      parts_(parts),
      components_(grid.components),
      extent_(grid.dimensions),
      blocks_(extent_, level_count(extent_)),
      entries_(grid) {
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
  // Those of a step follow each other, because a step needs all of its own.
  std::ranges::stable_sort(from(begin), merged_.end(), {}, [this](const Place& place) {
    return std::pair(place.component / components_, place.run->first);
  });
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
  if (place.component > 0) payload = with_component(payload, place.component, numbers_of(place));
  return true;
}

// Returns the number of cubes or blocks of a component.
std::uint64_t ValuesChunks::numbers_of(const Place& place) const {
  const Extent cubes = cube_extent(extent_);
  return place.run ? std::uint64_t{cubes[0]} * cubes[1] * cubes[2] : blocks_.count();
}

ChunkPlace ValuesChunks::chunk_place(const Place& place) {
  if (place.cluster) return {ChunkType::values, 0, 0, place.cluster->block, place.cluster->index};
  return {place.gaps ? ChunkType::gaps : ChunkType::remainders, 0, 0, place.run->first, place.run->count};
}

std::optional<OutgoingChunk> ValuesChunks::chunk(std::size_t i) const {
  const Place place = place_of(i);
  OutgoingChunk chunk = without_payload(place);
  return read(place, chunk.payload) ? std::optional(std::move(chunk)) : std::nullopt;
}

std::optional<OutgoingChunk> ValuesChunks::outline(std::size_t i) const {
  const Place place = place_of(i);
  OutgoingChunk chunk = without_payload(place);
  // A payload begins with a number, which in the stream also counts the cubes or blocks of earlier components.
  const std::uint64_t number = place.run ? place.run->first : place.cluster->block;
  std::vector<std::byte> own, in_stream;
  put_number(own, number);
  put_number(in_stream, number + place.component * numbers_of(place));
  chunk.payload.resize((place.run ? place.run->bytes : place.cluster->bytes) + in_stream.size() - own.size());
  return chunk;
}

OutgoingChunk ValuesChunks::without_payload(const Place& place) const {
  OutgoingChunk chunk;
  chunk.entry = entries_(chunk_place(place));
  if (place.component > 0) chunk.entry.vectors = 0;
  if (parts_.size() > components_) chunk.entry.parent = static_cast<std::uint32_t>(place.component / components_);
  if (place.run) {
    chunk.type = place.gaps ? ChunkType::gaps : ChunkType::remainders;
    // A lost chunk of gaps leaves wrong values where there are none.
    if (place.gaps) chunk.gain = most_gain_;
    return chunk;
  }
  chunk.type = ChunkType::values;
  chunk.gain = static_cast<double>(place.cluster->gain) * parts_[place.component].weight;
  chunk.chain = static_cast<std::uint32_t>(place.component * blocks_.count() + place.cluster->block);
  return chunk;
}

std::optional<Listing> ValuesChunks::listing(std::span<const DirectoryEntry> entries, const Box& /*box*/) const {
  if (components_ > 1) return std::nullopt;
  const Extent cubes = cube_extent(extent_);
  const std::uint64_t all_cubes = std::uint64_t{cubes[0]} * cubes[1] * cubes[2];
  std::vector<ChunkPlace> places;
  places.reserve(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Place place = place_of(i);
    places.push_back(chunk_place(place));
    places.back().first += place.component * (place.cluster ? blocks_.count() : all_cubes);
    places.back().offset = entries[i].offset;
    places.back().bytes = entries[i].bytes;
  }
  return Listing{ChunkType::places, pack_places(places)};
}

std::size_t ValuesChunks::entry_bytes() const { return components_ > 1 ? kDirectoryEntryBytes : kMostPlaceBytes; }

}  // namespace gs::qnv::values
