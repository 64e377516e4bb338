#pragma once

#include "app/formats/splats/splats.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Import of points with normals as QNV surfaces. Each point becomes a vector. The area comes from the property `area`,
/// else from an estimate by neighbours (point_areas). Positions and axes are unchanged. Results are two-sided surfaces
/// with box and total.
///
/// The metadata has "source" and these counts unless they are 0: "points broken" (not finite, or without normal or
/// area), "points missing" (the header announces them, the file lacks them), and "points doubled".
///
/// Any thread. Safe for untrusted input. Memory is bounded by a multiple of the file size.

/// Imports ASCII or binary PLY. The element vertex has x y z and nx ny nz, and optionally area and red green blue.
/// Colours are integers 0..255 or decimals 0..1.
[[nodiscard]] ImportedVectors import_points_ply(std::span<const std::byte> bytes,
                                                const WorldBudget& budget = own_budget());
/// Returns true if a PLY file has vertices with normals, but no faces, lines or strips.
[[nodiscard]] bool is_points_ply(std::span<const std::byte> bytes);

/// Imports text with one point per line: x y z nx ny nz, and optionally r g b from 0 to 255. Ignores lines that begin
/// with #.
[[nodiscard]] ImportedVectors import_points_xyz(std::span<const std::byte> bytes,
                                                const WorldBudget& budget = own_budget());

/// Imports PCD of the Point Cloud Library with normal_x, normal_y and normal_z, and perhaps rgb or rgba.
[[nodiscard]] ImportedVectors import_points_pcd(std::span<const std::byte> bytes,
                                                const WorldBudget& budget = own_budget());
/// Returns true if a PCD file has normals.
[[nodiscard]] bool is_points_pcd(std::span<const std::byte> bytes);

}  // namespace gs::app
