#pragma once

#include "qnv/container/container.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

// Directory of a stream of Gaussians: about 7 bytes per chunk. FORMAT.md, "Directory of clusters".

/// Encodes entries of Gaussians as the payloads of chunks of type ChunkType::cluster_directory. `box` is that of the
/// stream. Returns nullopt if the format does not support an entry, such as a parent that follows its child.
[[nodiscard]] std::optional<std::vector<std::vector<std::byte>>> pack_clusters(std::span<const DirectoryEntry> entries,
                                                                               const Box& box);

/// Decoder of the chunks of a directory: ChunkType::directory, and in streams of Gaussians also
/// ChunkType::cluster_directory. Safe for untrusted bytes.
class DirectoryReader {
 public:
  explicit DirectoryReader(const StreamHeader& header);
  ~DirectoryReader();
  DirectoryReader(DirectoryReader&&) noexcept;
  DirectoryReader& operator=(DirectoryReader&&) noexcept;

  /// Appends the entries of the next chunk to `entries`. Returns false if the chunk is no directory of this stream, if
  /// it is invalid, or if `entries` has kMaxDirectoryEntries entries.
  bool add(ChunkType type, std::span<const std::byte> payload, std::vector<DirectoryEntry>& entries);

 private:
  struct Clusters;
  bool add_clusters(std::span<const std::byte> payload, std::vector<DirectoryEntry>& entries);

  Box box_;
  bool gaussians_;
  std::unique_ptr<Clusters> clusters_;  // state of the decoder of clusters; null until their first chunk
};

}  // namespace gs::qnv
