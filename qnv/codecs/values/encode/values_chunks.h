#pragma once

#include "qnv/codecs/shared/stream_writer.h"
#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/chunk_places.h"
#include "qnv/codecs/values/encode/encode_values.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Encoded parts of one component, or of one component of a step, each in the order of its chunks.
struct ComponentParts {
  std::vector<StoredRun> gaps;
  std::vector<StoredCluster> clusters;
  std::vector<StoredRun> remainders;
  double weight = 1;  // factor from the squared error of a sample to that of its value

  [[nodiscard]] std::uint32_t chunks() const {
    return static_cast<std::uint32_t>(gaps.size() + clusters.size() + remainders.size());
  }
};

/// Chunks of a values stream, with payloads in a store: the gaps, the clusters, then the remainders. The clusters of
/// several components are in the order of their gain per byte.
class ValuesChunks final : public ChunkList {
 public:
  /// The arguments must outlive the list.
  ValuesChunks(const ValueGrid& grid, const SpillStore& store, std::span<const ComponentParts> parts);

  [[nodiscard]] std::size_t size() const override;
  [[nodiscard]] std::optional<OutgoingChunk> chunk(std::size_t i) const override;
  [[nodiscard]] std::optional<OutgoingChunk> outline(std::size_t i) const override;
  /// Returns nullopt for several components, because places name blocks of one. They count those of all steps.
  [[nodiscard]] std::optional<Listing> listing(std::span<const DirectoryEntry> entries, const Box& box) const override;
  [[nodiscard]] std::size_t entry_bytes() const override;

 private:
  /// Part of the stream that a chunk holds: a run or a cluster.
  struct Place {
    const StoredRun* run = nullptr;
    const StoredCluster* cluster = nullptr;
    std::size_t component = 0;
    bool gaps = false;
  };
  void merge();
  [[nodiscard]] Place place_of(std::size_t i) const;
  [[nodiscard]] OutgoingChunk without_payload(const Place& place) const;
  [[nodiscard]] std::uint64_t numbers_of(const Place& place) const;
  [[nodiscard]] bool read(const Place& place, std::vector<std::byte>& payload) const;

  /// Returns the place of a chunk, with the number in its step.
  [[nodiscard]] static ChunkPlace chunk_place(const Place& place);

  const SpillStore& store_;
  std::span<const ComponentParts> parts_;  // by step, then by component
  std::size_t components_;                 // of a step
  Extent extent_;
  BlockLayout blocks_;
  PlaceEntries entries_;
  std::vector<Place> merged_;  // of several components, in the order of the stream
  double most_gain_ = 0;
};

}  // namespace gs::qnv::values
