#pragma once

#include "qnv/codecs/gaussians/lod/chunk_repair.h"
#include "qnv/codecs/gaussians/lod/splat_tree.h"
#include "qnv/codecs/gaussians/lod/stored_models.h"
#include "qnv/codecs/gaussians/splat_code.h"
#include "qnv/codecs/gaussians/splat_models.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/container/container.h"
#include "qnv/container/lost_chunks.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::gaussians {

/// Data of a cluster that decoding its children requires.
struct SplatState {
  std::vector<SplatNode> inner;  // Gaussians that children may replace, in the order of the stream
  StoredModels models;           // at the end of the cluster

  [[nodiscard]] std::size_t bytes() const {
    return sizeof(SplatState) + inner.capacity() * sizeof(SplatNode) + models.bytes();
  }
};

/// Decoded parent of a cluster.
struct SplatParent {
  const SplatState& state;
  std::span<const std::uint16_t> ranks;  // number of inner Gaussians before each Gaussian, then in all
};

/// Decoded cluster. Its memory can be reused for the next cluster.
struct DecodedCluster {
  std::vector<SplatNode> nodes;     // in the order of the stream
  std::vector<NodeOrigin> origins;  // parents are indices in SplatState::inner; empty without harmonics
  SplatModels models;               // at the end of the cluster
  std::vector<std::byte> chunk;
};

/// Harmonics of a cluster, as received. The arrays have harmonic_count() coefficients per Gaussian, or are empty.
struct ClusterHarmonics {
  std::vector<glm::vec3> leaves, merged;
  std::vector<bool> known_leaves, known_merged;  // one per Gaussian: has received harmonics; empty if none has
  bool damaged = false;                          // a chunk is damaged
};

/// Chunks of a stream of Gaussians, and the tree of their clusters. The stream is in memory, in a file, or still
/// growing. One thread at a time. Safe for untrusted bytes.
class SplatChunks {
 public:
  using Opened = std::variant<SplatChunks, StreamProblem>;

  /// Opens a complete stream. With `trust_directory`, reads only the header and the directory now. Without it, or if
  /// the directory is incomplete or wrong, reads the whole stream once.
  [[nodiscard]] static Opened open(std::shared_ptr<const ChunkSource> source, bool trust_directory);
  /// Opens a growing stream from its first bytes, which must contain the whole header.
  [[nodiscard]] static Opened begin(std::span<const std::byte> front);

  bool push(std::span<const std::byte> bytes);
  void finish();
  bool set_directory(std::span<const std::byte> chunks);
  bool add(std::uint64_t offset, std::span<const std::byte> chunk);
  void set_most_bytes(std::size_t most_bytes);

  /// Reads the head of a received cluster if it is not known. Returns false if that fails; the cluster is then broken.
  bool read_head(std::uint32_t cluster);
  /// Decodes a received cluster. `parent` is null for the root. Returns false if the bytes are invalid. May run in
  /// several threads at once.
  [[nodiscard]] bool decode(std::uint32_t cluster, const SplatParent* parent, DecodedCluster& to) const;
  /// Decodes the received harmonics of a cluster. `leaves` are its leaves, and `merged` its other Gaussians except
  /// unchanged ones, both in the order of the stream.
  [[nodiscard]] ClusterHarmonics decode_harmonics(std::uint32_t cluster, std::span<const SplatNode> leaves,
                                                  std::span<const SplatNode> merged) const;

  /// Sets whether restore() waits for a running repair, or returns at once. The default is to wait.
  void set_waiting(bool waiting) { waiting_ = waiting; }
  /// Restores damaged chunks of a file by parity. Another thread reads the whole file, but only once. Returns true if
  /// this call added restored chunks.
  bool restore();
  /// Reports whether a repair is running. Clusters that cannot be decoded may be restored soon.
  [[nodiscard]] bool repairing() const { return repair_ != nullptr; }
  /// Reports whether a repair has ended, so that restore() adds its chunks without waiting.
  [[nodiscard]] bool repaired() const { return repair_ && repair_->ended(); }
  /// Leaves a damaged cluster to the running repair. Until the repair ends, it is not decoded.
  void postpone(std::uint32_t cluster);

  /// Received chunk, for decoders of the whole stream.
  struct Received {
    ChunkType type = ChunkType::gaussians;
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;
  };
  /// Returns all received chunks: clusters with parents before children, then harmonics. All harmonics have one type.
  [[nodiscard]] std::vector<Received> received() const;
  [[nodiscard]] const std::shared_ptr<const ChunkSource>& source() const { return source_; }

  void reject(std::uint32_t cluster, std::string why);
  [[nodiscard]] const StreamHeader& header() const { return header_; }
  [[nodiscard]] const Precision& precision() const { return precision_; }
  [[nodiscard]] SplatTree& tree() { return tree_; }
  [[nodiscard]] const SplatTree& tree() const { return tree_; }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return problems_; }
  /// Returns a counter that increases with every received chunk.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

 private:
  explicit SplatChunks(StreamHeader header);
  [[nodiscard]] static Opened make(std::variant<StreamHeader, StreamProblem> read);
  void read_directory_of_source();
  [[nodiscard]] bool directory_fits() const;
  void scan();
  bool take_restored(const ChunkRepair::Restored& chunk);
  bool take_restored_cluster(std::span<const std::byte> payload, const ChunkRepair::Restored& chunk, std::string& why);
  bool take(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset);
  bool store(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset);
  bool note(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset, std::string& why);
  void copy_problems();
  void problem(std::uint64_t offset, std::string message);

  StreamHeader header_;
  Precision precision_;
  SplatTree tree_;
  std::shared_ptr<const ChunkSource> source_;
  std::shared_ptr<ArrivedChunks> arrived_;  // source_ of a growing stream, else null
  std::shared_ptr<ArrivedChunks> patches_;  // restored chunks of a source with parity, else null
  bool whole_ = false;                      // all chunks of the source were read once, or a repair reads them
  bool waiting_ = true;
  std::unique_ptr<ChunkRepair> repair_;   // null if none is running
  std::vector<std::uint32_t> postponed_;  // clusters that wait for the repair
  StreamReader reader_;
  LostChunks lost_;  // of a growing stream
  std::uint64_t restored_ = 0;
  std::size_t reader_problems_ = 0;
  std::vector<StreamProblem> problems_;
  std::uint64_t revision_ = 0;
};

}  // namespace gs::qnv::gaussians
