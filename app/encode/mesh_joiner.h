#pragma once

#include "qnv/base/geometry.h"
#include "qnv/base/triangles.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Builder of an indexed mesh from single triangles. Corners that are equal in position, normal, colour and texture
/// coordinate share a vertex. Either all triangles have texture coordinates, or none.
class MeshJoiner {
 public:
  /// Maximum memory per triangle, in bytes.
  static constexpr std::size_t kTriangleBytes = 400;

  /// Adds a triangle. Corners without normal get the normal of the face. Leaves out triangles without area.
  void add(const qnv::Triangle& triangle, const std::optional<std::array<glm::vec2, 3>>& at = {});
  [[nodiscard]] std::size_t triangles() const { return mesh_.triangles.size() / 3; }
  /// Returns the mesh. The areas of its vertices sum up to the area of the surface.
  [[nodiscard]] qnv::IndexedMesh take();

 private:
  /// Bits of the properties of a corner: position, normal, colour, texture coordinate.
  using Corner = std::array<std::uint32_t, 9>;
  struct Hash {
    std::size_t operator()(const Corner& corner) const;
  };

  qnv::IndexedMesh mesh_;
  std::unordered_map<Corner, std::uint32_t, Hash> vertices_;
};

}  // namespace gs::app
