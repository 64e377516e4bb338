#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/values/bricks/received/cube_flags.h"
#include "qnv/codecs/values/bricks/received/kept_payloads.h"
#include "qnv/codecs/values/cube_runs.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv::values {

/// Place of a run of remainders in a stream.
struct RunPlace {
  std::uint64_t first = 0;   // number of its first cube
  std::uint64_t offset = 0;  // of the chunk header
  std::uint32_t bytes = 0;   // including the chunk header
  std::uint32_t count = 0;   // cubes
};

/// Remainders of a volume that is larger than memory: the chunks of a file, or received ones. One thread at a time.
class RemainderRuns : NonCopyable {
 public:
  /// Uses the chunks of a file, and reads them whenever they are needed. Without a file, uses the kept ones.
  RemainderRuns(Extent extent, std::shared_ptr<const ChunkSource> source, KeptPayloads& kept)
      : extent_(extent), source_(std::move(source)), kept_(kept) {}

  /// Notes where a run is. Returns false if it is not in the volume, at another place than noted before, or if the runs
  /// have far more cubes than the volume.
  bool note(const RunPlace& place);
  [[nodiscard]] std::size_t count() const { return places_.size(); }
  /// Returns the owner of a run in KeptPayloads. Clusters have lower numbers.
  [[nodiscard]] static constexpr std::uint64_t owner(std::uint64_t first) { return std::uint64_t{1} << 63 | first; }

  /// Calls visit(place) for each run with cubes in a box of voxels, in order.
  void visit(const SampleBox& box, const std::function<void(const RunPlace&)>& visit) const;
  [[nodiscard]] bool has(const RunPlace& place) const { return source_ || kept_.has(place.offset); }
  /// Adds the remainders of the cubes with flags to `numbers`, which covers the box of `cubes`. Clears the flags of
  /// cubes in missing or damaged runs. Any thread, while no other thread changes this.
  void add(CubeFlags& cubes, std::span<std::uint32_t> numbers) const;

 private:
  [[nodiscard]] std::optional<CubeRun> read(const RunPlace& place) const;
  static constexpr std::size_t kMostLate = 4096;  // runs that come after later ones

  Extent extent_;
  std::shared_ptr<const ChunkSource> source_;
  KeptPayloads& kept_;
  std::vector<RunPlace> places_;  // by the first cube
  std::uint64_t cubes_ = 0;
  std::size_t late_ = 0;
};

}  // namespace gs::qnv::values
