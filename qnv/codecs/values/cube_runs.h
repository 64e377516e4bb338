#pragma once

#include "qnv/codecs/values/block_places.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::values {

// Per-voxel data outside of the transform: gaps, and remainders of exact or corrected values. Both visit the volume in
// cubes of kCubeEdge voxels per axis, x first. A run of cubes is one chunk, which is decoded alone. FORMAT.md, "Gaps"
// and "Remainders".

/// Run of cubes as the payload of a chunk.
struct CubeRun {
  std::uint64_t first = 0;  // number of the first cube
  std::uint32_t count = 0;
  std::vector<std::byte> bytes;
};

/// Maximum number of cubes of a run.
inline constexpr std::uint32_t kMostRunCubes = 1u << 20;

/// Returns the number of cubes per axis.
[[nodiscard]] Extent cube_extent(Extent extent);

[[nodiscard]] std::vector<std::byte> pack(const CubeRun& run);
/// Safe for untrusted bytes.
[[nodiscard]] std::optional<CubeRun> parse_run(std::span<const std::byte> payload);

/// Encodes which voxels are missing. `missing` has one entry per voxel, 0 or 1, and does not change. Runs without
/// missing voxels are left out.
[[nodiscard]] std::vector<CubeRun> encode_gaps(std::span<std::uint8_t> missing, Extent extent);
/// Sets the voxels of a run. Voxels outside of the volume do not matter. Returns false if the run is not in the volume,
/// or truncated.
bool decode_gaps(const CubeRun& run, Extent extent, std::span<std::uint8_t> missing);

/// Encodes one remainder per voxel. Runs of zeros are left out.
[[nodiscard]] std::vector<CubeRun> encode_remainders(std::span<const std::uint32_t> remainders, Extent extent);
/// Adds the remainders of a run to the codes of its voxels; otherwise like decode_gaps().
bool decode_remainders(const CubeRun& run, Extent extent, std::span<std::uint32_t> codes);

}  // namespace gs::qnv::values
