#pragma once

#include "base/box.h"
#include "qnv/codecs/gaussians/encode/harmonics_chunks.h"
#include "qnv/codecs/gaussians/encode/splat_clusters.h"
#include "qnv/codecs/shared/spill_store.h"
#include "qnv/codecs/shared/stream_writer.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::qnv::gaussians {

/// Encoded chunk of a stream without its bytes.
struct ChunkRecord {
  std::uint64_t offset = 0;  // of the bytes in the store
  std::uint32_t bytes = 0;   // without the head
  ChunkType type = ChunkType::gaussians;
  std::uint32_t level = 0;
  std::uint32_t parent = ClusterHead::kNoParent;  // record of the replaced cluster, or of the harmonics' cluster
  std::uint32_t first = 0, count = 0;             // as in the head
  std::uint32_t vectors = 0, replaced = 0;
  double gain = 0;  // reduction of the squared error
  Box box;
};

/// Store of bytes. Any thread.
class SharedStore {
 public:
  /// Result of finished work, and the offset of its bytes in the store.
  struct Finished {
    std::uint64_t offset = 0;
    std::vector<std::byte> result;
  };

  explicit SharedStore(SpillStore& store) : store_(store) {}

  /// Adds bytes. Returns their offset, or nullopt if they cannot be stored.
  [[nodiscard]] std::optional<std::uint64_t> add(std::span<const std::byte> bytes);
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const;
  [[nodiscard]] std::string problem() const;

  /// Adds the bytes of finished work, and records it for later runs. Returns their offset, or nullopt on failure.
  [[nodiscard]] std::optional<std::uint64_t> finish(std::string_view work, std::span<const std::byte> bytes,
                                                    std::span<const std::byte> result);
  /// Returns work that an earlier run finished. Returns nullopt if there is none, or if its bytes are damaged.
  [[nodiscard]] std::optional<Finished> finished(std::string_view work) const;

 private:
  SpillStore& store_;
  mutable std::mutex mutex_;
};

/// Records of the chunks of one tree, in the order in which they were encoded. One thread.
class ChunkRecords {
 public:
  /// `first_id` is the identifier of the first cluster; lower identifiers belong to other records.
  ChunkRecords(SharedStore& store, std::uint32_t first_id) : store_(store), first_id_(first_id) {}
  /// Constructs records of another process from its records() and clusters().
  ChunkRecords(SharedStore& store, std::uint32_t first_id, std::span<const ChunkRecord> records,
               std::span<const std::uint32_t> clusters)
      : store_(store),
        first_id_(first_id),
        records_(records.begin(), records.end()),
        clusters_(clusters.begin(), clusters.end()) {}

  /// Adds a cluster and its harmonics. Returns false if the store is full.
  [[nodiscard]] bool add(const EncodedCluster& cluster, std::span<const EncodedHarmonics> harmonics, const Box& box);
  /// Returns the last cluster's identifier plus 1.
  [[nodiscard]] std::uint32_t end_id() const { return first_id_ + static_cast<std::uint32_t>(clusters_.size()); }
  /// Appends the records to `all`. `clusters` has the indices of the clusters before `first_id` in `all`; the first
  /// call sets it.
  void append_to(std::vector<ChunkRecord>& all, std::vector<std::uint32_t>& clusters) const;
  [[nodiscard]] std::span<const ChunkRecord> records() const { return records_; }
  [[nodiscard]] std::span<const std::uint32_t> clusters() const { return clusters_; }

  /// Copies all chunks to `store`, and records them as finished work. `bytes` must be the store of these records, and
  /// hold nothing else. Returns the records in `store`, or nullptr on failure.
  [[nodiscard]] std::unique_ptr<ChunkRecords> finish(std::string_view work, const SpillStore& bytes,
                                                     SharedStore& store) const;
  /// Returns the records that an earlier run finished. Returns nullptr if there are none with this `first_id`.
  [[nodiscard]] static std::unique_ptr<ChunkRecords> finished(std::string_view work, std::uint32_t first_id,
                                                              SharedStore& store);

 private:
  SharedStore& store_;
  std::uint32_t first_id_;
  std::vector<ChunkRecord> records_;     // parents are identifiers of clusters
  std::vector<std::uint32_t> clusters_;  // records of the clusters from first_id_ on
};

/// Chunks in the order of the stream: the most useful first, but each cluster before the chunks that require it.
class OrderedChunks final : public ChunkList {
 public:
  /// Parents of `records` are indices in `records`. Omits further clusters once `most_vectors` Gaussians are shown; 0
  /// means unlimited.
  OrderedChunks(std::vector<ChunkRecord> records, std::size_t most_vectors, const SharedStore& store);

  [[nodiscard]] std::size_t size() const override { return order_.size(); }
  [[nodiscard]] std::optional<OutgoingChunk> chunk(std::size_t i) const override;
  [[nodiscard]] std::optional<OutgoingChunk> outline(std::size_t i) const override;
  [[nodiscard]] std::optional<Listing> listing(std::span<const DirectoryEntry> entries, const Box& box) const override;

 private:
  [[nodiscard]] OutgoingChunk packed(std::size_t i, std::span<const std::byte> bytes) const;
  void find_order(std::size_t most_vectors);
  void add_gains();

  std::vector<ChunkRecord> records_;
  std::vector<std::uint32_t> ids_, order_;  // identifiers of the clusters by record; records in the order of the stream
  const SharedStore& store_;
};

/// Returns the bounds of Gaussians, clipped to the box of the stream.
[[nodiscard]] Box bounds_of(std::span<const SplatNode> nodes, const Box& whole);

}  // namespace gs::qnv::gaussians
