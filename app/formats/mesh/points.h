#pragma once

#include "app/formats/splats/splats.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Clouds of points with normals as surfaces of QNV: each point becomes a disc, with the area that the file gives
/// it (property `area`), else the one that its neighbours leave it (point_areas). Positions are the file's, no axes are
/// turned. Kind surface, two-sided, with box and total; metadata "source" and, where not 0, "points broken"
/// (not finite, no normal, no area), "points missing" (announced, not there) and "points doubled". Any thread;
/// safe for untrusted input, memory is bounded by a multiple of the file.

/// PLY, ascii or binary: element vertex with x y z, nx ny nz, and possibly red green blue (integers 0..255 or
/// floating-point 0..1), area.
[[nodiscard]] ImportedCloud import_points_ply(std::span<const std::byte> bytes,
                                              const WorldBudget& budget = own_budget());
/// True for a PLY file of vertices with normals and no faces, lines or strips.
[[nodiscard]] bool is_points_ply(std::span<const std::byte> bytes);

/// Text with a point a line: x y z nx ny nz, and possibly r g b from 0 to 255. Lines that begin with # are
/// passed over.
[[nodiscard]] ImportedCloud import_points_xyz(std::span<const std::byte> bytes,
                                              const WorldBudget& budget = own_budget());

}  // namespace gs::app
