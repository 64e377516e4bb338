#pragma once

#include "qnv/base/description.h"

#include <glm/vec3.hpp>

#include <array>
#include <functional>
#include <span>

namespace gs::qnv {

/// Triangle of a surface, counter-clockwise seen from outside; world units.
struct Triangle {
  std::array<glm::vec3, 3> positions{};
  std::array<glm::vec3, 3> normals{};  // unit shading normals of the corners; zero means the face's own normal
  std::array<Rgb8, 3> colors{};  // colours of the corners
};

/// Callback that receives triangles in the order of their creation. Returns false to stop the source.
using TriangleSink = std::function<bool(std::span<const Triangle>)>;

}  // namespace gs::qnv
