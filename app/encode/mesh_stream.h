#pragma once

#include "app/formats/common/color_key.h"
#include "qnv/codecs/shared/encode_options.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace gs::app {

/// Mesh that is read from its file triangle by triangle, so that it may exceed memory. Files are binary STL, or binary
/// PLY with faces after vertices. Polygons become fans of triangles. Corners have no normals. Faces with invalid
/// corners are skipped. A truncated file gives its complete faces. The source has runs of kRunFaces faces. One
/// thread at a time.
struct MeshStream {
  static constexpr std::uint64_t kRunFaces = std::uint64_t{1} << 16;

  std::uint64_t faces = 0;              // number of faces that the file contains
  glm::vec3 size{0};                    // size of the bounding box; 0 if unknown before all triangles are read
  glm::dvec3 origin{0};                 // origin of the triangle coordinates, in world units
  std::optional<ColorKey> color_key{};  // values that the colours represent
  qnv::TriangleSource source{};
  std::string omitted{};  // warning that counts the omitted cells of a grid; empty if there are none
};

/// Callback that may release the first bytes of the file from memory. The argument is the number of these bytes.
using PutAside = std::function<void(std::size_t)>;

/// Opens a mesh file. Returns nullopt if the format is another one, or if the file is compressed. `bytes` must outlive
/// the result. Safe for untrusted input.
[[nodiscard]] std::optional<MeshStream> open_mesh_stream(std::span<const std::byte> bytes,
                                                         const PutAside& put_aside = {});

}  // namespace gs::app
