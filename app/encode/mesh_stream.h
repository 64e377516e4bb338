#pragma once

#include "qnv/encode/encode_surface.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

namespace gs::app {

/// A mesh whose triangles are read one after the other out of its file, which may be larger than memory: binary STL,
/// and binary PLY whose faces follow its vertices. Faces of more corners are fans. Corners have no normals. Faces with
/// a corner that is not there are left out, and so is what a file that ends too early lacks. Any thread, one at a time.
struct MeshStream {
  std::uint64_t faces = 0;  // that are there, as far as the file's header and length tell
  glm::vec3 size{0};        // of the box of its vertices, where that is known without reading all of the file
  glm::dvec3 origin{0};     // from which the triangles count, world units
  qnv::TriangleSource source;
};

/// Is told how many bytes from the front on need not stay in memory.
using PutAside = std::function<void(std::size_t)>;

/// Nothing for files of another kind, those that are packed among them. The bytes must outlive it. Safe for untrusted
/// ones.
[[nodiscard]] std::optional<MeshStream> open_mesh_stream(std::span<const std::byte> bytes,
                                                         const PutAside& put_aside = {});

}  // namespace gs::app
