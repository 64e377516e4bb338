#pragma once

#include "app/insitu/bricks/pyramid.h"
#include "app/insitu/bricks/zarr_container.h"
#include "base/noncopyable.h"
#include "net/serve/http_server.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace gs::app::insitu {

/// Grid of a step that rank 0 serves. Requests of viewers create its chunks.
struct ServedGrid {
  std::uint64_t serial = 0;  // number of the kept step, equal on all ranks
  std::string container;     // name of its folder, such as "heat.000120.zarr"
  Pyramid pyramid;
  ZarrGrid grid;
  double max_error = 0;
  std::uint32_t thinning = 1;
  /// Reads layers of a chunk from the memory of this process, from the layer `first` on. Null if other ranks send
  /// chunks. Any thread.
  std::function<void(const Chunk& chunk, std::uint32_t first, std::span<float> values)> read;
  /// Chunks of the overview, if ranks have sent them.
  std::map<Chunk, std::vector<float>> received;
};

/// Chunk that viewers requested from a step.
struct WantedChunk {
  std::uint64_t serial = 0;
  Chunk chunk;
};

/// Encoded and requested chunks of the two newest steps, on rank 0. Used by the server's thread, which encodes, and by
/// the simulation's thread, which delivers the chunks of other ranks.
class BrickShelf : NonCopyable {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMaxSteps = 2;
  static constexpr std::size_t kMaxEncodedBytes = std::size_t{4} << 20;
  static constexpr std::size_t kMaxReceivedBytes = std::size_t{16} << 20;

  /// Limits of the work for viewers. The server's thread calls both functions.
  struct Share {
    std::function<bool()> permits;  // reports whether a chunk below the overview may be encoded now
    // Charges processor time of the server's thread since the last call. `overview` is its part for an overview chunk.
    std::function<void(double overview, std::size_t bytes)> charge;
  };
  explicit BrickShelf(Share share) : share_(std::move(share)) {}

  /// Adds the newest step. Keeps the step before it, and drops older ones.
  void put(ServedGrid grid);
  /// Drops all steps but the newest one, so that callers can reuse the memory of the others.
  void drop_older();
  /// Returns the content of a path of a container. Its state is `waiting` until the other ranks have sent the chunk and
  /// the share permits encoding it. Chunks of the overview do not wait for the share. Other containers are `gone`.
  /// Server's thread.
  [[nodiscard]] net::HeldContent content(const std::string& path);
  /// Returns requested chunks of the newest steps, the coarsest first, and notes that the ranks send them.
  [[nodiscard]] std::vector<WantedChunk> take_wanted(std::size_t most);
  /// Receives a chunk of other ranks. Without values, viewers must request it again. Ignores it if its step was
  /// dropped. Above kMaxReceivedBytes, drops the chunks that wait longest; viewers request them again.
  void deliver(const WantedChunk& wanted, std::vector<float> values);

  /// Reports whether a viewer has requested the overview of the newest step; true if there is no step.
  [[nodiscard]] bool is_seen() const;
  /// Reports whether viewers refine a step: a request waits, or the last one is less than half a second old. Returns
  /// false if the newest step is older than two seconds.
  [[nodiscard]] bool is_busy(Clock::time_point now) const;

 private:
  struct Slot {
    ServedGrid grid;
    std::map<Chunk, std::string> encoded;
    std::set<Chunk> wanted, sent;  // requested by viewers; requested from ranks
    Clock::time_point begun{};
    bool seen = false;
  };
  [[nodiscard]] Slot* find(std::uint64_t serial);
  [[nodiscard]] Slot take_oldest();
  [[nodiscard]] net::HeldContent chunk_content(std::unique_lock<std::mutex>& lock, const std::string& container,
                                               const Chunk& chunk);
  void drop_encoded();
  void drop_received();

  const Share share_;
  mutable std::mutex mutex_;          // guards the members below
  std::deque<Slot> slots_;            // newest last
  std::deque<WantedChunk> order_;     // encoded chunks, oldest first
  std::deque<WantedChunk> received_;  // chunks below the overview that ranks have sent, oldest first
  std::size_t encoded_bytes_ = 0;
  ChunkEncoder encoder_;         // used by the server's thread only, without the lock
  Clock::time_point refined_{};  // time of the last request for a chunk below the overview
};

}  // namespace gs::app::insitu
