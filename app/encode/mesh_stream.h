#pragma once

#include "qnv/codecs/shared/encode_options.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

namespace gs::app {

/// Mesh that is read triangle by triangle from its file, which may exceed memory: binary STL, or binary PLY with faces
/// after vertices. Polygons become fans. Corners have no normals. Skips faces with invalid corners; a truncated file
/// yields only its complete faces. Callable from any thread, one at a time.
struct MeshStream {
  std::uint64_t faces = 0;  // number of faces present, by the file's header and length
  glm::vec3 size{0};        // size of the bounding box, if known without reading the whole file
  glm::dvec3 origin{0};     // origin of the triangles, in world units
  qnv::TriangleSource source;
};

/// Callback that may release the file's first bytes from memory; the argument is their number.
using PutAside = std::function<void(std::size_t)>;

/// Opens a mesh file. Returns nullopt for other formats and for compressed files. `bytes` must outlive the result. Safe
/// for untrusted input.
[[nodiscard]] std::optional<MeshStream> open_mesh_stream(std::span<const std::byte> bytes,
                                                         const PutAside& put_aside = {});

}  // namespace gs::app
