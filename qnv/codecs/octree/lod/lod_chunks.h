#pragma once

#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/octree/lod/lod_tree.h"
#include "qnv/codecs/octree/packed.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Memory limits of a stream.
struct LodLimits {
  std::size_t cache_bytes = std::size_t{1} << 29;    // decoded data that the last cuts do not need
  std::size_t discs = std::size_t{1} << 26;          // splats of one cut or of whole(), for any budget
  std::size_t arrived_bytes = std::size_t{1} << 30;  // received chunks of a stream that still grows
};

/// Decoded cluster that is not added to the tree yet.
struct DecodedCluster {
  std::unique_ptr<Cluster> cluster;  // nullptr if decoding failed; `problem` is then the reason
  std::string problem;
  NormalCone cone;
  std::uint32_t discs = 0, replaced = 0;  // number of its splats, and of the parent's splats that these replace
};

/// Returns the bounds of `count` voxels from index `first` on, units of the stream.
[[nodiscard]] Box box_of_run(const PackedVoxels& voxels, int level, std::size_t first, std::size_t count,
                             const Cube& cube);

/// Chunks of an octree stream, and the tree of their clusters. The stream is in memory, in a file, or still growing.
/// One thread at a time. Safe for untrusted bytes.
class LodChunks {
 public:
  using Opened = std::variant<LodChunks, StreamProblem>;
  /// Callback that receives the node of each new cluster.
  using OnCluster = std::function<void(std::uint32_t node)>;

  /// Opens a complete stream. With `trust_directory`, reads only the header and the directory now; if the directory is
  /// incomplete or wrong, and without `trust_directory`, reads the whole stream once.
  [[nodiscard]] static Opened open(std::shared_ptr<const ChunkSource> source, bool trust_directory);
  /// Opens a growing stream from its first bytes, which must contain the whole header.
  [[nodiscard]] static Opened begin(std::span<const std::byte> front);

  /// Adds bytes to a growing stream. Returns false if further bytes are useless.
  bool push(std::span<const std::byte> bytes, const OnCluster& on_cluster = {});
  /// Ends a growing stream.
  void finish(const OnCluster& on_cluster);
  /// Sets the directory of a growing stream. Returns false if `chunks` is incomplete.
  bool set_directory(std::span<const std::byte> chunks);
  /// Adds a whole chunk of a growing stream at its offset. Returns false if the chunk is rejected.
  bool add(std::uint64_t offset, std::span<const std::byte> chunk, const OnCluster& on_cluster);
  /// Limits the received chunks of a growing stream, in bytes.
  void set_most_bytes(std::size_t most_bytes);
  [[nodiscard]] bool grows() const { return arrived_ != nullptr; }

  /// Decodes one cluster without storing it. `parent` is the decoded parent, or nullptr for the root. Pure function;
  /// any thread.
  [[nodiscard]] DecodedCluster decode(std::uint32_t node, const Cluster* parent) const;
  /// Marks a cluster as broken, and records the problem at its offset.
  void reject(std::uint32_t node, std::string why);

  [[nodiscard]] const StreamHeader& header() const { return header_; }
  [[nodiscard]] const LodTree& tree() const { return tree_; }
  [[nodiscard]] LodTree& tree() { return tree_; }
  /// Returns the problems in the bytes read so far.
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return problems_; }
  /// Returns a counter that increases with every received chunk.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

 private:
  explicit LodChunks(StreamHeader header) : header_(std::move(header)) {}
  static Opened make(std::variant<StreamHeader, StreamProblem> header);
  void read_directory_of_source();
  void scan();
  [[nodiscard]] bool directory_fits() const;
  bool take(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset, const OnCluster& on_cluster);
  void problem(std::uint64_t offset, std::string message);
  void copy_problems();

  StreamHeader header_;
  std::shared_ptr<const ChunkSource> source_;
  std::shared_ptr<ArrivedChunks> arrived_;  // same object as source_ in a growing stream, otherwise null
  StreamReader reader_;                     // reader of the bytes passed to push()
  std::size_t reader_problems_ = 0;         // number of problems already copied from reader_
  LodTree tree_;
  std::vector<StreamProblem> problems_;
  std::uint64_t revision_ = 1;
};

}  // namespace gs::qnv
