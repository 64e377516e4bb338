#pragma once

#include "app/formats/vtk/poly_data.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Reads a legacy VTK file, which other files may name. Reports problems. Throws OutOfBudget.
[[nodiscard]] PolyData read_vtk_legacy(std::span<const std::byte> bytes, MeshBuilder& builder);

}  // namespace gs::app
