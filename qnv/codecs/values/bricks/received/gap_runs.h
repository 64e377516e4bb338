#pragma once

#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/decode/unit_mask.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Missing voxels of a volume that is larger than memory, as they are coded.
class GapRuns {
 public:
  explicit GapRuns(Extent extent) : extent_(extent) {}

  /// Adds a run. Returns false if it is not in the volume, known, or if the runs have far more cubes than the volume.
  bool add(CubeRun run);
  [[nodiscard]] std::size_t count() const { return runs_.size(); }
  /// Writes `number` to the missing voxels of a box, x first. Reports whether there can be any. Any thread, while no
  /// other thread adds runs.
  bool mark(const SampleBox& box, std::int32_t number, std::span<std::int32_t> to) const;

 private:
  Extent extent_;
  std::vector<CubeRun> runs_;  // by the first cube
  std::uint64_t cubes_ = 0;
  static constexpr std::size_t kMostLate = 4096;  // runs that come after later ones
  std::size_t late_ = 0;
};

}  // namespace gs::qnv::values
