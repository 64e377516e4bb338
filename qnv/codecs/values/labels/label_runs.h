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
  std::uint64_t first = 0;  // code of the first cube
  std::uint32_t count = 0;  // of codes
  std::vector<std::byte> bytes;
};

[[nodiscard]] std::vector<std::byte> pack(const LabelRun& run);
/// Parses a payload. Returns nullopt if it is invalid. Safe for untrusted bytes.
[[nodiscard]] std::optional<LabelRun> parse_label_run(std::span<const std::byte> payload);

/// Labels of one level: indices in the palette.
struct LabelGrid {
  Extent extent{};
  std::vector<std::uint32_t> labels;  // x first
};

/// Encodes a level. `count` is the number of labels in the palette. Passes the runs to `take`, in order.
void encode_label_runs(const LabelGrid& grid, const CubeOrder& order, std::uint32_t count, int level,
                       const std::function<void(LabelRun&&)>& take);

/// Decodes a run into the labels of its level. Calls decoded(cube) for each cube. Returns false if the run is not in
/// the level, or truncated. Safe for untrusted runs.
bool decode_label_run(const LabelRun& run, const CubeOrder& order, std::uint32_t count, LabelGrid& grid,
                      const std::function<void(const Extent& cube)>& decoded);

}  // namespace gs::qnv::values
