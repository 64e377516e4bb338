#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/container/container.h"
#include "qnv/sampling/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::qnv::values {

// Directory of a values stream: about 2 bytes per chunk. FORMAT.md, "Places".

/// Place of a chunk in a stream, and its part of the volume.
struct ChunkPlace {
  ChunkType type = ChunkType::values;
  std::uint64_t offset = 0;  // of the chunk header
  std::uint32_t bytes = 0;   // including the chunk header
  std::uint64_t first = 0;   // block of a cluster; first cube of a run; of a time series, counted over all steps
  std::uint32_t count = 0;   // index of a cluster in its block; cubes of a run
  friend bool operator==(const ChunkPlace&, const ChunkPlace&) = default;
};

/// Maximum bytes of a place in the directory, for volumes that encoders support.
inline constexpr std::size_t kMostPlaceBytes = 14;

/// Encodes places of ascending offsets as the payloads of chunks. The clusters of a block must be in order.
[[nodiscard]] std::vector<std::vector<std::byte>> pack_places(std::span<const ChunkPlace> places);

/// Decoder of the places of a stream. Safe for untrusted bytes.
class PlacesReader {
 public:
  /// Adds the payload of the next chunk. Returns false if it is invalid, or after kMaxDirectoryEntries places.
  bool add(std::span<const std::byte> payload);
  [[nodiscard]] const std::vector<ChunkPlace>& places() const { return places_; }

 private:
  std::vector<ChunkPlace> places_;
  std::unordered_map<std::uint64_t, std::uint32_t> counts_;  // of clusters, by block
  std::uint64_t end_ = 0;                                    // of the last place
};

/// Decodes all places from the concatenated chunks. Returns nullopt if they are damaged, or not as many as the header
/// announces.
[[nodiscard]] std::optional<std::vector<ChunkPlace>> places_of(std::span<const std::byte> chunks,
                                                               const StreamHeader& header);

/// Converts places to the entries of a general directory. `grid` is that of the stream. The first numbers of a time
/// series count all steps; the parent of its entries is the step.
class PlaceEntries {
 public:
  explicit PlaceEntries(const ValueGrid& grid, bool series = false);
  [[nodiscard]] DirectoryEntry operator()(const ChunkPlace& place) const;

 private:
  VolumeLayout layout_;
  BlockLayout blocks_;
  bool series_;
};

}  // namespace gs::qnv::values
