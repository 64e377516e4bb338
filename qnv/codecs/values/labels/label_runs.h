#pragma once

#include "qnv/codecs/values/labels/cube_order.h"
#include "qnv/codecs/values/lifting.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::values {

// Labels of one level, in runs of cubes. A run is one chunk, which is decoded alone, so that a lost one costs its cubes
// at one level. FORMAT.md, "Labels", defines the decisions.

/// Run of cubes in the order of CubeOrder, as the payload of a chunk.
struct LabelRun {
  std::uint8_t level = 0;   // each label stands for 2^level voxels per axis
  std::uint64_t first = 0;  // code of the first cube; of a time series, plus the codes of the steps before
  std::uint32_t count = 0;  // of codes
  bool differs = false;     // cubes may keep the labels of the step before
  std::vector<std::byte> bytes;
};

[[nodiscard]] std::vector<std::byte> pack(const LabelRun& run);
/// Parses a payload. Returns nullopt if it is invalid. Safe for untrusted bytes.
[[nodiscard]] std::optional<LabelRun> parse_label_run(std::span<const std::byte> payload);
/// Returns the step of a run of a time series, and subtracts it from the first code. `codes` is the number of codes of
/// the run's level.
[[nodiscard]] std::uint64_t take_step(LabelRun& run, std::uint64_t codes);

/// Labels of one level: indices in the palette.
struct LabelGrid {
  Extent extent{};
  std::vector<std::uint32_t> labels;  // x first
};

/// Labels of one cube in memory, x first.
struct CubeLabels {
  const std::uint32_t* labels = nullptr;  // of the cube's first voxel
  std::size_t row = 0, slice = 0;         // distances of voxels along y and z
};

/// Labels of one level, which may be larger than memory.
class LabelCubes {
 public:
  LabelCubes() = default;
  LabelCubes(const LabelCubes&) = delete;
  LabelCubes& operator=(const LabelCubes&) = delete;
  virtual ~LabelCubes() = default;

  [[nodiscard]] virtual const Extent& extent() const = 0;
  /// Returns the labels of a cube of the level. They are valid up to the next call.
  [[nodiscard]] virtual CubeLabels cube(const Extent& cube) = 0;
};

/// Number of codes in a segment of a level. Encoders end runs at the ends of segments, so that threads and processes
/// can encode segments independently.
inline constexpr std::uint64_t kSegmentCodes = std::uint64_t{1} << 16;

/// Encodes a segment of a level. `count` is the number of labels in the palette. `before` is the level in the previous
/// step. Keeps cubes that equal those of `before`, and omits runs of kept cubes only. Passes the runs in order to
/// `take`, until it returns false.
void encode_label_runs(LabelCubes& level_labels, const CubeOrder& order, std::uint64_t segment, std::uint32_t count,
                       int level, const std::function<bool(LabelRun&&)>& take, LabelCubes* before = nullptr);

/// Decodes a run of a level. Calls decoded(cube, labels) for each cube that is not kept, in order. Needs memory for the
/// cubes of the run. Returns false if the run is not in the level, or truncated. Safe for untrusted runs.
bool decode_label_run(const LabelRun& run, const CubeOrder& order, const Extent& extent, std::uint32_t count,
                      const std::function<void(const Extent& cube, const CubeLabels& labels)>& decoded);

}  // namespace gs::qnv::values
