#pragma once

#include "app/formats/export/export.h"

#include <cstddef>
#include <span>
#include <string>

namespace gs::app {

/// Exports geometry with triangles as binary glTF 2.0: a mesh with normals and colours, or with its texture image as
/// received. Refuses files over 4 GiB.
[[nodiscard]] Exported export_glb_mesh(const qnv::IndexedMesh& mesh, const ExportOptions& options = {});

/// Assembles a GLB file from JSON and binary data; the binary length must be a multiple of four (glTF 2.0, 4).
[[nodiscard]] Exported glb_file(std::string text, std::span<const std::byte> binary);

}  // namespace gs::app
