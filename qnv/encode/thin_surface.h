#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/parallel.h"
#include "qnv/encode/encode_surface.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace gs::qnv {

/// A surface with fewer triangles than the one that it was made of.
struct ThinnedSurface {
  std::vector<glm::vec3> positions;  // units of the source
  std::vector<Rgb8> colors;          // one a position
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// Gives them, without normals. Refers to this.
  [[nodiscard]] TriangleSource source() const;
};

/// Thins a surface that is too large for memory to at most `most` triangles, and not far fewer where it has them: all
/// corners in a cell of a grid become one, at the place that is nearest to the planes of their triangles, so that
/// edges stay sharp (P. Lindstrom, Out-of-core simplification of large polygonal models, 2000). Details smaller than a
/// cell go. The source is read three to six times, and never held: memory is about 130 bytes for each triangle of
/// `most`. The same input gives the same surface.
[[nodiscard]] std::variant<ThinnedSurface, EncodeError> thin_surface(const TriangleSource& source, std::size_t most,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
