#pragma once

#include "app/formats/export/export.h"

#include <cstddef>
#include <span>
#include <string>

namespace gs::app {

/// Exports vectors with triangles as a binary glTF 2.0 mesh. The mesh has normals, and either colours or the received
/// texture image. Refuses files over 4 GiB.
[[nodiscard]] Exported export_glb_mesh(const qnv::IndexedMesh& mesh, const ExportOptions& options = {});

/// Assembles a GLB file from JSON and binary data (glTF 2.0, 4). The size of `binary` must be a multiple of four.
[[nodiscard]] Exported glb_file(std::string text, std::span<const std::byte> binary);

}  // namespace gs::app
