#pragma once

#include "qnv/base/cloud.h"

#include <glm/vec3.hpp>

#include <array>
#include <functional>
#include <span>

namespace gs::qnv {

/// One triangle of a surface, counter-clockwise seen from outside; world units.
struct Triangle {
  std::array<glm::vec3, 3> positions{};
  std::array<glm::vec3, 3> normals{};  // unit, for shading, a corner each; zero: the face's own
  std::array<Rgb8, 3> colors{};        // a corner each
};

/// Takes triangles in the order in which they are made; false: no more are wanted.
using TriangleSink = std::function<bool(std::span<const Triangle>)>;

}  // namespace gs::qnv
