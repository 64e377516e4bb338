#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/container/container.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

namespace gs::qnv::gaussians {

/// First offset of restored chunks: beyond the end of any stream, and beyond offsets of StreamFeed::add_loose().
inline constexpr std::uint64_t kNowhere = std::uint64_t{1} << 63;

/// Reads a whole stream of Gaussians and checks all checksums. Passes all sound chunks to `take`. With `parity`, also
/// passes restored chunks, with the offset kNowhere. Ends early when `stop` becomes true. Any thread.
[[nodiscard]] std::vector<StreamProblem> read_whole(const ChunkSource& source, bool parity,
                                                    const StreamReader::OnChunk& take,
                                                    const std::atomic<bool>* stop = nullptr);

/// Restoration of damaged chunks by parity. Reads the whole stream once, on a thread of its own.
class ChunkRepair : NonCopyable {
 public:
  /// Restored chunk, at its offset in the `patches`.
  struct Restored {
    ChunkType type = ChunkType::gaussians;
    std::uint64_t offset = 0;
    std::size_t bytes = 0;  // with the chunk header
  };
  struct Result {
    std::vector<Restored> chunks;
    std::vector<StreamProblem> problems;
  };

  /// Starts the reading. Adds restored chunks to `patches`, from the offset kNowhere on.
  ChunkRepair(std::shared_ptr<const ChunkSource> source, std::shared_ptr<ArrivedChunks> patches);
  /// Ends the reading early, and waits for its thread.
  ~ChunkRepair();

  /// Reports whether the result is complete, so that finish() does not block.
  [[nodiscard]] bool ended() const { return ended_; }
  /// Waits until the whole stream is read. Returns the result. Call it once.
  [[nodiscard]] Result finish();

 private:
  void run();

  std::shared_ptr<const ChunkSource> source_;
  std::shared_ptr<ArrivedChunks> patches_;
  Result result_;        // belongs to the thread until `ended_`
  bool failed_ = false;  // belongs to the thread until `ended_`
  std::atomic<bool> stop_ = false, ended_ = false;
  std::thread thread_;
};

}  // namespace gs::qnv::gaussians
