#pragma once

#include "app/formats/export/export.h"

#include <cstddef>
#include <span>
#include <string>

namespace gs::app {

/// glTF 2.0 binary of a cloud with triangles: a mesh with normals and colours, or its picture, which is in the file as
/// it came. Refuses more than 4 GiB.
[[nodiscard]] Exported export_glb_mesh(const qnv::Cloud& cloud, const ExportOptions& options = {});

/// A GLB file of its two parts: JSON, and binary data whose length is a multiple of four (glTF 2.0, 4).
[[nodiscard]] Exported glb_file(std::string text, std::span<const std::byte> binary);

}  // namespace gs::app
