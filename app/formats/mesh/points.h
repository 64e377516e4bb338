#pragma once

#include "app/formats/splats/splats.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Import of points with normals as QNV surfaces: each point becomes a vector. Its area is the property `area`, or else
/// an estimate from its neighbours (point_areas). Positions and axes are unchanged. Results are two-sided surfaces with
/// box and total. Metadata: "source" and, unless 0, "points broken" (not finite, no normal or area), "points missing"
/// (announced but absent), and "points doubled". Runs on any thread. Safe for untrusted input; memory is bounded by a
/// multiple of the file size.

/// Imports PLY, ASCII or binary: element vertex with x y z, nx ny nz, and optionally area and red green blue (integers
/// 0..255 or floating-point 0..1).
[[nodiscard]] ImportedCloud import_points_ply(std::span<const std::byte> bytes,
                                              const WorldBudget& budget = own_budget());
/// Reports whether a PLY file has vertices with normals, but no faces, lines or strips.
[[nodiscard]] bool is_points_ply(std::span<const std::byte> bytes);

/// Imports text with one point per line: x y z nx ny nz, and optionally r g b from 0 to 255. Ignores lines that begin
/// with #.
[[nodiscard]] ImportedCloud import_points_xyz(std::span<const std::byte> bytes,
                                              const WorldBudget& budget = own_budget());

}  // namespace gs::app
